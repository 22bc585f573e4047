// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

/// Recognizes a loaded compensation table in the change between two campaigns of an axis. Positions
/// and deviations may have any units, which must be equal in all arguments.
namespace nonio::statistics {

/// Mean deviations at ascending targets; empty for a direction that was not measured.
struct MeasuredCurve {
  std::vector<double> position{}, plus{}, minus{};
  /// Standard uncertainty of a mean without the parts that campaigns have in common; 0 if unknown.
  double u = 0.0;
};

/// Correction that is linear between the points and constant outside them, or repeats after a turn;
/// zero without points.
struct TableCurve {
  std::vector<double> position{}, plus{}, minus{};
  double turn = 0.0;  ///< length after which it repeats; 0: it does not
  /// Lets a table over one `length` with equal ends repeat.
  void repeat_after(double length);
  bool empty() const { return position.empty(); }
  double at(double x, int direction) const;
  /// Moves the entries by `points` points towards larger positions.
  TableCurve shifted(int points) const;
};

enum class Loading { loaded, removed, wrong_sign, twice, in_addition, offset };

struct TableChange {
  Loading loading = Loading::loaded;
  std::size_t table = 0;  ///< index into the known tables; not used for `removed`
  int points = 0;         ///< offset in points, positive towards larger positions
  double rms = 0.0;       ///< RMS of the change after removal of a constant per direction
  /// RMS of the part that the table does not explain, without a constant per direction.
  double left = 0.0;
  double p = 0.0;  ///< probability of such an unexplained part by chance
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
/// The best h by chi2 is returned if (1) the part that h does not explain is noise (p > 1e-3, and
/// less than 0.4 of the change) or less than a tenth of h, (2) neither no change nor a change of
/// scale or reversal explains it as well (chi2 larger by 25), (3) no other hypothesis does (chi2
/// larger by 9). std::nullopt otherwise, and if the campaigns have too few positions in common, or
/// positions over at most half of the range of `after`. An offset that cannot be distinguished from
/// none is `loaded`. `resolution` is the smallest standard uncertainty of a difference. Without
/// `active`, S is empty or any known table. Source: least squares; limits by simulation
/// (tests/property/loaded_table_test.py).
std::optional<TableChange> recognize(const MeasuredCurve& before, const MeasuredCurve& after,
                                     const std::optional<TableCurve>& active,
                                     const std::vector<TableCurve>& known, double u_slope,
                                     double resolution);

/// Returns the known table that leaves the smallest part of the change unexplained, even if
/// `recognize` does not recognize it. std::nullopt if no table changes the axis at these positions
/// or if the campaigns have too few positions in common. `p` is NaN.
std::optional<TableChange> nearest(const MeasuredCurve& before, const MeasuredCurve& after,
                                   const std::optional<TableCurve>& active,
                                   const std::vector<TableCurve>& known, double resolution);

}  // namespace nonio::statistics
