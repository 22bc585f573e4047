// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/circle.h"
#include "nonio/sdk/plugin.h"

namespace nonio::circle {

struct Circle {
  std::array<std::string, 2> axis;  ///< first and second axis of the plane
  std::array<double, 2> centre{};   ///< commanded, m
  double R = 0.0;                   ///< commanded radius, m
  std::vector<math::CircleReading> readings;
  bool plus = false, minus = false;  ///< whether each direction was measured
  double step = 0.0;                 ///< typical largest angle between neighboring readings, rad

  bool both() const { return plus && minus; }
  std::vector<math::CircleReading> of(int direction, std::uint32_t run) const;
};

Expected<Circle> circle_of(const Measurement&, const Observations&);

/// Rounds x to ten digits of `size`, so that results are identical on all processors.
double steady(double x, double size);

/// One named value of the decomposition of the path deviations.
struct CauseValue {
  std::string name;     ///< C0Y, B_X, lateral_X, ...
  std::string finding;  ///< finding id if significant ("circle.squareness"); may be empty
  std::string axis;     ///< empty if it concerns both axes
  double value = 0.0;   ///< SI
  Quantity quantity = Quantity::deviation;
  double u = 0.0;              ///< standard uncertainty by repetition
  std::vector<double> by_bin;  ///< derivative with respect to the means of the fit
  double alone = 0.0;          ///< circular deviation due to this cause alone, m
};

/// Inputs of the decomposition that the readings do not contain.
struct Wish {
  bool calibrated_length = false;
  std::optional<double> feed{};  ///< m/s; absent if not stated
};

/// Values that the readings determine, in report order. A finding for each other value is added to
/// `refused`.
std::vector<CauseValue> cause_values(const Circle&, const math::CircleModel&, const math::CauseFit&,
                                     const Wish&, std::vector<Finding>& refused);

/// Name of the squareness in the plane ("C0Y", "A0Z", "B0Z"), and its sign in the model of the fit.
std::pair<std::string, double> squareness_of(const Circle&);

}  // namespace nonio::circle
