// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "laboratory/statistics/series.h"

/// Difference between two campaigns, and effect of a compensation table compared with its
/// prediction. Uncertainties of a common source cancel. Source: JCGM 100:2008, 5.2; zeta score of
/// ISO 13528 (difference over its standard uncertainty; E_n with k = 2 is half of this score).
namespace nonio::statistics {

struct Difference {
  double value = 0.0, u = 0.0;
  double p = 1.0;  ///< two-sided, normal distribution

  double zeta() const { return u > 0.0 ? value / u : 0.0; }
};

/// Returns after - before - expected. An error if `check` rejects a point (1 is before, 2 is
/// after), or if `expected` or `u_expected` is not finite or `u_expected` is negative.
Expected<Difference> difference(const Point& before, const Point& after, double expected = 0.0,
                                double u_expected = 0.0);

/// Step from as found to as left, compared with the step predicted for a table.
struct TableCheck {
  Difference from_predicted;
  /// Fraction of the error as found that was compensated; negative if the error increased.
  /// std::nullopt if the error as found is at most twice its standard uncertainty.
  std::optional<double> taken{};
  bool as_promised = true;  ///< whether the difference is not significant at 1 %
};

/// Compares as-left minus as-found with the predicted step `promised`. `u_promised` is its standard
/// uncertainty from rounding and from interpolation between the points of the table.
Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised = 0.0);

}  // namespace nonio::statistics
