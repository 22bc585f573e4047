// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

/// Recognizes whether the change between two campaigns of an axis is a table that was loaded.
/// Positions and deviations may have any units, the same in all arguments.
namespace nonio::statistics {

/// Mean deviations at targets in ascending order; a direction that was not measured is empty.
struct MeasuredCurve {
  std::vector<double> position{}, plus{}, minus{};
  double u = 0.0;  ///< standard uncertainty of one mean, without parts that campaigns have in
                   ///< common; 0: unknown
};

/// Correction of a table: linear between its points, constant outside them, and zero if it has no
/// points.
struct TableCurve {
  std::vector<double> position{}, plus{}, minus{};
  bool empty() const { return position.empty(); }
  double at(double x, int direction) const;
  /// Returns the table with its entries moved by `points` points towards larger positions.
  TableCurve shifted(int points) const;
};

enum class Loading { loaded, removed, wrong_sign, twice, in_addition, offset };

/// A change that was recognized as a table.
struct TableChange {
  Loading loading = Loading::loaded;
  std::size_t table = 0;  ///< index into the known tables; not used if `removed`
  int points = 0;         ///< number of points of an `offset`, positive towards larger positions
  double rms = 0.0;       ///< rms of the change after removal of a constant for each direction
  double left = 0.0;      ///< rms of the part of the change that the table does not explain,
                          ///< computed in the same way
  double p = 0.0;         ///< probability that an unexplained part at least this large occurs by
                          ///< chance
};

/// Recognizes a change as a table. The model is
///
///   after - before = h + a constant of each direction + b (x - mean of x),
///
/// where b is 0 with standard uncertainty `u_slope`. With S the table active before and T a known
/// table, h is
///
///   T - S     loaded                   -S         removed
///   -T - S    loaded with the wrong sign, also of the difference: S - T
///   2 T - S   loaded twice, also of the difference: 2 (T - S)
///   T         loaded in addition to S
///   T(x - k spacings) - S   loaded with an offset of k points, |k| <= 5
///
/// The best h by chi2 is returned if three conditions are met. First, the part of the change that h
/// does not explain is noise (p > 1e-3, and less than 0.4 of the change) or less than a tenth of h.
/// Second, neither no change nor a change of scale or of reversal explains the change as well (chi2
/// larger by 25). Third, no other hypothesis explains it as well (chi2 larger by 9). None is
/// returned otherwise, and if the campaigns have too few positions in common, or positions over at
/// most half of the axis. An offset that cannot be distinguished from none is `loaded`.
/// `resolution` is the smallest standard uncertainty of a difference. If `active` is none, the
/// active table is unknown; S is then nothing or any of the known tables. Source: least squares;
/// limits by simulation (tests/property/loaded_table_test.py).
std::optional<TableChange> recognize(const MeasuredCurve& before, const MeasuredCurve& after,
                                     const std::optional<TableCurve>& active,
                                     const std::vector<TableCurve>& known, double u_slope,
                                     double resolution);

/// Returns the known table that would leave the smallest part of the change unexplained if it was
/// loaded, however large that part is, for changes that `recognize` does not recognize. None if no
/// table changes the axis at these positions, or if both campaigns have too few positions in
/// common. `p` of the result is NaN.
std::optional<TableChange> nearest(const MeasuredCurve& before, const MeasuredCurve& after,
                                   const std::optional<TableCurve>& active,
                                   const std::vector<TableCurve>& known, double resolution);

}  // namespace nonio::statistics
