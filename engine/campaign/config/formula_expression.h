// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

/// Powers of length, time and temperature; an angle has none.
using Dimension = std::array<int, 3>;

/// The expression of a formula over slots: variables, units, parameters, each a number in SI.
class Expression {
 public:
  enum Variable : std::size_t {
    p,
    theta,
    d,
    t,
    K,
    run,
    // A parameter may have the name of one of these: then it is the parameter.
    length,
    duration,
    runs,
    pitch,
    teeth,
    air,
    pressure,
    humidity,
    variables
  };

  /// Fails where the expression cannot be understood, with its position. `known`: it was understood
  /// before, so that only the names in it are declared.
  static Expected<Expression> parse(const Formula& formula, const Axis& axis, bool known = false);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Slots with the units in place, variables and parameters 0.
  std::vector<double> slots() const;
  static std::size_t parameter_slot(std::size_t k);
  /// The same quantities in a system whose unit number `k` (0 length, 1 time, 2 temperature) is
  /// smaller by 2^bits.
  std::vector<double> in_finer_units(std::vector<double> slots, std::size_t k, int bits) const;
  /// NaN or infinite where the expression has no value there.
  double value(const std::vector<double>& slots);
  /// The same of the slots in place.
  std::vector<double>& in_place();
  double value();
  bool uses(const std::string& name) const;

 private:
  struct Parser;
  Expression();
  std::unique_ptr<Parser> parser_;
};

Dimension dimension_of(Quantity quantity);

}  // namespace nonio::config
