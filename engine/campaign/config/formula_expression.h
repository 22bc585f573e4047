// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

/// Exponents of length, time and temperature in a unit; all 0 for an angle.
using Dimension = std::array<int, 3>;

/// The slots of an expression contain the values of variables, units and parameters in SI units.
class Expression {
 public:
  enum Variable : std::size_t {
    p,
    theta,
    d,
    t,
    K,
    run,
    // A parameter of the formula may have one of the following names, which then denotes it.
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

  /// `known`: the expression was parsed before, and only the names that occur in it are declared.
  static Expected<Expression> parse(const Formula& formula, const Axis& axis, bool known = false);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Returns a copy of the slots. After `parse`, the units have their values in SI units, `length`,
  /// `duration`, `runs`, `pitch` and `teeth` are 1, and all others are 0.
  std::vector<double> slots() const;
  static std::size_t parameter_slot(std::size_t k);
  /// Converts slots to units in which the unit of dimension `k` (0: length, 1: time, 2:
  /// temperature) is smaller by a factor of 2^bits.
  std::vector<double> in_finer_units(std::vector<double> slots, std::size_t k, int bits) const;
  /// Evaluates the expression; NaN or infinity if it has no finite value.
  double value(const std::vector<double>& slots);
  /// Returns the slots that `value()` without an argument uses, to be changed in place.
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
