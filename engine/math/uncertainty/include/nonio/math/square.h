// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/measured_line.h"
#include "nonio/sdk/campaign.h"

/// Squareness of two axes from two lines of straightness measured against the faces of one square.
///
/// Axis 1 moves along one face, and b1 is the least-squares slope of its deviations toward axis 2;
/// b2 is that of axis 2 toward axis 1. The faces enclose 90 degrees + g in the quadrant between
/// both positive directions. Then b1 + b2 = t + g with the sum t of the slopes of both axes toward
/// each other; the set-up of the square changes b1 and b2 by opposite amounts and cancels:
///
///     C0Y = -t     B0Z = +t     A0Z = -t
///
/// If the square is turned over about one of its faces, its error is -g: t is the mean of both
/// positions, g half their difference. C0Y is that of least-squares lines (C0Y_LSQ). Derived.
namespace nonio::math {

struct SquareLines {
  std::string square, state;
  std::string name;  ///< name of the squareness: C0Y, B0Z, A0Z
  std::string first, second;
  std::vector<std::size_t> unturned;  ///< indices of the measurements: `first`, then `second`
  std::vector<std::size_t> turned;    ///< indices of measurements after the square was turned over
  bool whole() const { return unturned.size() == 2 && (turned.empty() || turned.size() == 2); }
  /// In the order of the manifest.
  std::vector<std::size_t> all() const;
};

/// Groups lines of straightness against squares by square, state and plane.
std::vector<SquareLines> squares_of(const Campaign&);

struct Squareness {
  double value = 0.0;  ///< squareness of the machine, rad
  /// g, if the square was turned over; its u by repetition is `u`
  std::optional<double> of_square{};
  double u = 0.0;  ///< standard uncertainty by repetition; 0 if a line has no repetition
  Shares shares;
  ReadingModel model;
  /// for the budget: largest standard uncertainty of a stop, smallest degrees of freedom of a line
  double largest_u = 0.0, dof = 0.0;
  std::vector<Finding> findings;  ///< limits of the manifest that the readings exceed
};

/// `one-line`, `unknown` (the square was not turned over, and its error is not stated), `too-few`
/// or `incomplete`. `which`: name of the square for the first two, otherwise id of the measurement.
struct NoSquareness {
  std::string why;
  std::string which;
};
tl::expected<Squareness, NoSquareness> squareness_of(const Campaign&,
                                                     const std::vector<Observations>& all,
                                                     const SquareLines&);

/// Two independent results for one quantity, combined and compared.
struct OneQuantity {
  double value = 0.0, u = 0.0;  ///< mean weighted by 1/u^2, and its standard uncertainty
  double dof = INFINITY;
  double difference = 0.0;
  double p = 1.0;  ///< probability of a difference this large by chance
};
OneQuantity one_quantity(double a, const Expanded& of_a, double b, const Expanded& of_b);

}  // namespace nonio::math
