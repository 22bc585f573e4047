// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"

/// Difference between two campaigns, and whether a compensation table had its predicted effect.
/// Uncertainties of a common source cancel. Source: JCGM 100:2008, 5.2; ISO 13528 zeta score
/// (difference over its standard uncertainty; E_n with k = 2 is half of this score).
namespace nonio::statistics {

struct Difference {
  double value = 0.0, u = 0.0;
  double p = 1.0;  ///< two-sided, normal: probability of a difference at least this large by chance

  double zeta() const { return u > 0.0 ? value / u : 0.0; }
};

/// Returns after - before - expected. Returns an error if `check` rejects a point (1 is before, 2
/// is after), if `expected` or `u_expected` is not finite, or if `u_expected` is below 0.
Expected<Difference> difference(const Point& before, const Point& after, double expected = 0.0,
                                double u_expected = 0.0);

/// Result of comparing the step from as found to as left with the step that was predicted for a
/// table.
struct TableCheck {
  Difference from_predicted;
  /// Fraction of the error as found that the table compensated: 1 all, 0 none, below 0: made worse.
  /// None if the error as found is within twice its standard uncertainty.
  std::optional<double> taken{};
  bool as_promised = true;  ///< whether the difference is not significant at 1 %
};

/// Compares as-left minus as-found with the predicted step `promised`. `u_promised` is its standard
/// uncertainty from rounding and from interpolation between the points of the table.
Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised = 0.0);

}  // namespace nonio::statistics
