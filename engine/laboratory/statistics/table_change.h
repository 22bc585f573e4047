// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

/// Whether what changed between two campaigns of an axis is a table that was loaded. Values in,
/// values out: positions and deviations have any units, the same everywhere.
namespace nonio::statistics {

/// Mean deviations at targets in ascending order; a direction that was not measured is empty.
struct MeasuredCurve {
  std::vector<double> position{}, plus{}, minus{};
  double u = 0.0;  ///< standard, of one mean, of what is new in each campaign; 0: not known
};

/// What a table adds, linear between its points, the end values outside; no points: nothing.
struct TableCurve {
  std::vector<double> position{}, plus{}, minus{};
  bool empty() const { return position.empty(); }
  double at(double x, int direction) const;
  /// The same entries, each `points` points further up.
  TableCurve shifted(int points) const;
};

enum class Loading { loaded, removed, wrong_sign, twice, in_addition, offset };

/// A change that equals what a table does.
struct TableChange {
  Loading loading = Loading::loaded;
  std::size_t table = 0;  ///< index into the known tables; of `removed`: not used
  int points = 0;         ///< of `offset`: towards larger positions
  double rms = 0.0;       ///< of the change without the constants of both directions
  double left = 0.0;      ///< the same of what the table does not explain
  double p = 0.0;         ///< of a rest as large by chance
};

/// after - before = h + a constant of each direction + b (x - mean of x), with b known to be
/// 0 with standard uncertainty `u_slope`. With S what was active before and T a known table, h is
///
///     T - S     loaded                   -S       removed
///     -T - S    loaded with the wrong sign, also of the difference: S - T
///     2 T - S   loaded twice, also of the difference: 2 (T - S)
///     T         loaded in addition to S
///     T(x - k spacings) - S   loaded with an offset of k points, |k| <= 5
///
/// The best h by chi2 is named if the rest is noise (p > 1e-3, and less than 0.4 of the change) or a tenth of h, if no
/// change, a change of scale or of reversal does not explain it (chi2 larger by 25), and if no h of
/// another name is as good (chi2 larger by 9); an offset that cannot be distinguished from none is
/// `loaded`. `resolution`: smallest standard uncertainty of a difference that is believed.
/// `active`: none: not known; then S is nothing or any of the known tables. Source: least squares;
/// limits by simulation (tests/property/loaded_table_test.py).
std::optional<TableChange> recognize(const MeasuredCurve& before, const MeasuredCurve& after,
                                     const std::optional<TableCurve>& active,
                                     const std::vector<TableCurve>& known, double u_slope,
                                     double resolution);

/// The known table that leaves least of the change if it was loaded, with what remains, whatever the rest is: for a
/// change without a name. None if no table changes the axis at these places. `p` is NaN.
std::optional<TableChange> nearest(const MeasuredCurve& before, const MeasuredCurve& after,
                                   const std::optional<TableCurve>& active,
                                   const std::vector<TableCurve>& known, double resolution);

}  // namespace nonio::statistics
