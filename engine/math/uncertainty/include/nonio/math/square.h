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
/// After the square is turned over about one of its faces it has the error -g: t is the mean of
/// both positions, g half their difference. Derived; tests compare it with exact transforms. As the
/// slopes are least-squares slopes, so is the squareness (C0Y_LSQ of diagonals).
namespace nonio::math {

/// The lines measured against one square in one plane and one state of the machine.
struct SquareLines {
  std::string square, state;
  std::string name;           ///< name of the squareness: C0Y, B0Z, A0Z
  std::string first, second;  ///< names of the axes
  /// indices of the measurements: of axis `first`, of axis `second`
  std::vector<std::size_t> unturned;
  /// indices of the measurements after the square was turned over
  std::vector<std::size_t> turned;
  bool whole() const { return unturned.size() == 2 && (turned.empty() || turned.size() == 2); }
  /// Returns all measurements, in the order of the manifest.
  std::vector<std::size_t> all() const;
};

/// Returns the lines of straightness that were measured against squares, grouped by square, state
/// and plane, in the order of the manifest.
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

/// Reason why no squareness is given: `one-line`, `unknown` (the square was not turned over, and
/// its error is not stated), `too-few` or `incomplete`. `which` is the name of the square for the
/// first two reasons, else the id of the measurement. `all` (below): observations of all
/// measurements of the campaign.
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
  double dof = INFINITY;        ///< degrees of freedom of u
  double difference = 0.0, u_difference = 0.0;
  double p = 1.0;  ///< probability of a difference this large by chance
};
OneQuantity one_quantity(double a, const Expanded& of_a, double b, const Expanded& of_b);

}  // namespace nonio::math
