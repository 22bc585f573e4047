// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "readings.h"

namespace nonio::circle {

/// One value of the decomposition, as it is named and printed.
struct CauseValue {
  std::string name;     ///< C0Y, B_X, lateral_X, ...
  std::string finding;  ///< of a significant one: "circle.squareness"; empty: it is no cause alone
  std::string axis;     ///< whose it is; empty: of both
  double value = 0.0;   ///< SI
  Quantity quantity = Quantity::deviation;
  double u = 0.0;              ///< of the repetition
  std::vector<double> by_bin;  ///< derivative by the means of the fit
  double alone = 0.0;          ///< circular deviation that it makes alone, m
};

/// What an analysis is requested.
struct Wish {
  bool calibrated_length = false;
  std::optional<double> feed{};  ///< m/s
};

/// Values that the readings give, in the order of the report; findings for what they cannot.
std::vector<CauseValue> cause_values(const Circle&, const math::CircleModel&, const math::CauseFit&,
                                     const Wish&, std::vector<Finding>& refused);

/// "C0Y", "A0Z", "B0Z" of a plane, and the sign of the squareness in it.
std::pair<std::string, double> squareness_of(const Circle&);

}  // namespace nonio::circle
