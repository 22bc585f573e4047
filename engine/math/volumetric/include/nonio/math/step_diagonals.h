// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/sdk/error.h"

/// Sequential step diagonals: along each of the four body diagonals of a volume the axes move one
/// after the other, n times each, and a flat mirror in the spindle is read after every move.
///
///     travel X, Y, Z; L = sqrt(X^2 + Y^2 + Z^2)   m
///     a = X/L, b = Y/L, c = Z/L                   direction cosines
///     e = (ex, ey, ez), each +1 or -1             direction of a pass; u = (ex a, ey b, ez c)
///     E_a(i) = (EXa, EYa, EZa)                    errors of axis a at position i = 0..n, m
///     p                                           nominal displacement so far, m
///     nu                                          set-up angle of a pass, rad: nu.u = 0
///     R = u.sum_a [E_a(j_a) - E_a(start)] + nu.p  reading minus the nominal one, m
///
/// Least squares: 9n function values, two set-up angles and the zero of each pass, and the zero of
/// each axis series. A rotation of the frame changes no reading: EYX, EZX and EZY are set to 0 at
/// the far end. Results that depend on an undetermined scale are not given. A beam that is not
/// parallel to the diagonal shortens the path by |nu|^2/2 of u.p, which is subtracted iteratively.
///
/// Averaging (perfect set-up only) uses the means over the four diagonals: dE_aa = r / u_a, dE_ba =
/// (e_a e_b r) / u_b, with r the increment of a reading over interval i of axis a. Three check sums
/// per step, sum of (product of the other two signs) r, are 0.
///
/// The functions are those on lines through the middle of the volume.
///
/// C0Y = -(slope EYX + slope EXY), B0Z = slope EZX + slope EXZ and A0Z = -(slope EZY + slope EYZ)
/// are those of least-squares lines (ISO 230-1); the totals of the diagonals determine them,
/// whatever the set-up. Positioning is given with its scale if that is known, otherwise minus its
/// end-point line.
///
/// The noise of a function is a random walk: sd E_ba(i) = sqrt(2i) u / (2 u_b) for averaging.
///
/// Source: derived; averaging: C. Wang, Rev. Sci. Instrum. 71 (2000) 3933 (text not available).
namespace nonio::math {

/// Largest number of steps, because the fit uses dense matrices.
inline constexpr std::size_t most_diagonal_steps = 100;

struct StepDiagonals {
  struct Pass {
    std::array<int, 3> sign{1, 1, 1};
    std::vector<double> reading;  ///< reading after each of the 3n moves, m; NaN: not taken
  };
  std::array<double, 3> low{}, travel{};  ///< start and length of travel of each axis, m
  std::array<std::size_t, 3> order{0, 1, 2};
  std::size_t n = 0;
  std::vector<Pass> passes;

  double diagonal() const;
  double position(std::size_t axis, std::size_t i) const {
    return low[axis] + travel[axis] * static_cast<double>(i) / static_cast<double>(n);
  }
  /// Returns how many of the first t moves each axis has made.
  std::array<std::size_t, 3> counts(std::size_t t) const;
};

/// Positioning of one axis measured separately, on a line through the middle of the volume.
struct AxisSeries {
  std::size_t axis = 0;
  std::vector<double> position, deviation;  ///< positions and their deviations, m
  double u = 0.0;  ///< standard uncertainty of one deviation; 0: that of the diagonal's readings
  /// visits that contribute to the deviations, sorted by time; may be empty
  std::vector<BudgetLine::Visit> visits{};
};

struct StepChoices {
  /// Whether the mirror is known to be square to the diagonals, to within u over a step.
  bool set_up_known = false;
  /// Whether the mirror was set square to the beam; otherwise the beam was aligned with the
  /// diagonal.
  bool mirror_to_beam = true;
  /// Standard uncertainty of a reading, m; 0: estimated from the residuals.
  double u_reading = 0.0;
};

struct Estimated {
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty by noise
  Shares shares;   ///< empty without a ReadingModel
};

struct StepCurve {
  std::string name;  ///< ISO 230-1 name of the error, such as EYX
  std::size_t axis = 0;
  /// for positioning: false if it is given minus its end-point line, because the scale is not known
  bool known = true;
  std::vector<double> position, value, u;  ///< positions, errors and their u by noise, m
  std::vector<Shares> shares;
};

/// Difference of an axis series from the diagonals alone, minus its least-squares line.
struct ShapeContrast {
  std::size_t axis = 0;
  double rms = 0.0, largest = 0.0, at = 0.0;  ///< rms and largest value, and its position, m
  double p = 1.0;
};

struct StepSolution {
  std::array<StepCurve, 9> curves;      ///< in the order EXX EYX EZX EXY EYY EZY EXZ EYZ EZZ
  std::array<Estimated, 3> squareness;  ///< C0Y, B0Z, A0Z, rad
  /// Number of unknowns, which are function values and, if the set-up is not known, set-up angles
  /// (9n + 8 for n steps along each axis and four passes), and their rank.
  std::size_t unknowns = 0, rank = 0;
  double u_reading = 0.0;  ///< standard uncertainty of a reading, stated or estimated, m
  double dof = 0.0;        ///< degrees of freedom of an estimated u_reading
  /// rad, for each pass; empty if the set-up is known or not separable from the scales.
  std::vector<double> set_up;
  std::vector<ShapeContrast> shapes;  ///< comparison with each axis series
  bool scales_known() const { return curves[0].known && curves[4].known && curves[8].known; }
};

/// Solves by least squares. Error: too many readings are missing to determine a function. Lines of
/// the model: the passes, each with its zero before the 3n readings, then the series.
Expected<StepSolution> solve_step_diagonals(const StepDiagonals&, const std::vector<AxisSeries>&,
                                            const StepChoices&, const ReadingModel* = nullptr);
/// Solves by averaging. Error: a body diagonal or a reading is missing. Lines of the model: passes.
Expected<StepSolution> average_step_diagonals(const StepDiagonals&, const StepChoices&,
                                              const ReadingModel* = nullptr);

/// Tests whether the check sums (see the head of this file) are 0 and constant.
struct StepChecks {
  std::array<double, 3> constant{};  ///< mean check sum of the moves of X, Y, Z, m
  double p_constant = 1.0;  ///< p-value of the most significant constant, times 3, at most 1
  double trend = 0.0;       ///< change of the check sums per step, m
  double p_trend = 1.0;
  double u_reading = 0.0;  ///< standard deviation of a reading from the check sums, m
  std::size_t count = 0;
};
StepChecks check_step_diagonals(const StepDiagonals&);

/// Returns the mean total of the diagonals minus its prediction from three axis series, m: mean D -
/// sum of (T_a/L) E_aa(T_a), scaled to the whole travel. std::nullopt if a total is missing, or an
/// axis has no series over more than 90 % of its travel.
std::optional<Estimated> close_lengths(const StepDiagonals&, const std::vector<AxisSeries>&,
                                       double u_reading);

}  // namespace nonio::math
