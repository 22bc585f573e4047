// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"

/// What changed between two campaigns, and whether a table did what it promised. What both have in
/// common (one source) cancels. Source: JCGM 100:2008, 5.2; ISO 13528 zeta score (difference over
/// its standard uncertainty; E_n with k = 2 is half of it).
namespace nonio::statistics {

struct Difference {
  double value = 0.0, u = 0.0;
  double p = 1.0;  ///< two-sided, normal: of one as large by chance

  double zeta() const { return u > 0.0 ? value / u : 0.0; }
};

/// after - before - expected. An error as `check` gives it, of point 1 (before) or 2, or where
/// `expected` is not a number.
Expected<Difference> difference(const Point& before, const Point& after, double expected = 0.0,
                                double u_expected = 0.0);

/// Whether a table did what it promised: as-left less as-found against the step that it was to
/// make.
struct TableCheck {
  Difference beside;  ///< of the promised step
  /// Share of the error as found that the table took away: 1 all, 0 none, below 0: made worse.
  /// None where the error as found is within twice its uncertainty.
  std::optional<double> taken{};
  bool as_promised = true;  ///< not beyond chance at 1 %
};

/// promised: as-left less as-found by the table alone; u_promised: of its rounding, and of the
/// interpolation between its points.
Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised = 0.0);

}  // namespace nonio::statistics
