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
///     travel X, Y, Z; L = sqrt(X^2 + Y^2 + Z^2)      m
///     a = X/L, b = Y/L, c = Z/L                       direction cosines
///     e = (ex, ey, ez), each +1 or -1                 direction of a pass; u = (ex a, ey b, ez c)
///     E_a(i) = (EXa, EYa, EZa)                        errors of axis a at its position i = 0..n, m
///     p                                               nominal displacement so far, m
///     nu                                              set-up angle of a pass, rad: nu.u = 0
///     R = u.sum_a [E_a(j_a) - E_a(start)] + nu.p      reading minus the nominal one, m
///
/// Least squares: 9n function values, two set-up angles per pass, the zero of each pass, and the
/// zero of each axis series d(x) = E_aa(x) + zero. A rotation of the frame moves no reading: EYX,
/// EZX and EZY are 0 at the far end while it is solved (three gauge rows, if the set-up is open).
/// The rank is found numerically; without axis series the set-up leaves two scales unknown, and
/// what depends on them is not given. Where the mirror is square to a beam that does not run along
/// the diagonal, the path is short by |nu|^2/2 of u.p: subtracted, with nu.E, and solved again,
/// twice.
///
/// Averaging (perfect set-up only), r = increment of a reading over interval i of axis a:
///     dE_aa = mean of r / u_a,   dE_ba = mean of (e_a e_b r) / u_b    over the four diagonals
///     check = sum of (product of the other two signs) r = 0           three a step
///     slope EYX + slope EXY = L (sum of ex ey D) / (4 X Y)            D: totals of the diagonals
///
/// The functions are those on lines through the middle of the volume: angular errors of an axis
/// that is measured on another line make the axis series disagree.
///
/// Given: straightness less its least-squares line (ISO 230-1), and with it
///     C0Y = -(slope EYX + slope EXY), B0Z = slope EZX + slope EXZ, A0Z = -(slope EZY + slope EYZ)
/// which no set-up error moves to first order: the slopes of the straightness lines, two by two,
/// are in the totals D of the diagonals. Positioning with its scale where that is known, else
/// less its end line.
///
/// Uncertainty: white noise u of single readings. A function is a sum of increments whose noises do
/// not cancel: a random walk, sd E_ba(i) = sqrt(2i) u / (2 u_b) for averaging.
///
/// Source: derived; the averaging is that of C. Wang, "Laser vector measurement technique for the
/// determination and compensation of volumetric positioning errors", Rev. Sci. Instrum. 71 (2000)
/// 3933 (text not at hand). Checked against exact transforms.
namespace nonio::math {

/// Largest number of steps: the fit is dense.
inline constexpr std::size_t most_diagonal_steps = 100;

struct StepDiagonals {
  struct Pass {
    std::array<int, 3> sign{1, 1, 1};
    std::vector<double> reading;  ///< after each of the 3n moves, m; NaN: not taken
  };
  std::array<double, 3> low{}, travel{};      ///< m, travel > 0
  std::array<std::size_t, 3> order{0, 1, 2};  ///< in which the axes move
  std::size_t n = 0;
  std::vector<Pass> passes;

  double diagonal() const;
  double position(std::size_t axis, std::size_t i) const {
    return low[axis] + travel[axis] * static_cast<double>(i) / static_cast<double>(n);
  }
  /// Moves of each axis after the first t of all.
  std::array<std::size_t, 3> counts(std::size_t t) const;
};

/// Positioning of one axis as measured for itself, on a line through the volume's middle.
struct AxisSeries {
  std::size_t axis = 0;
  std::vector<double> position, deviation;  ///< m
  double u = 0.0;  ///< standard uncertainty of one deviation; 0: as readings
  std::vector<BudgetLine::Visit> visits{};  ///< what the deviations were made of, by time; or none
};

struct StepChoices {
  /// The mirror is known to be square to the diagonals within u over a step.
  bool set_up_known = false;
  /// The mirror was set square to the beam (the usual way); else the beam runs along the diagonal.
  bool mirror_to_beam = true;
  /// Standard uncertainty of a reading, m; 0: from the residuals.
  double u_reading = 0.0;
};

struct Estimated {
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty of the noise
  Shares shares;   ///< and of the inputs of a ReadingModel, if there was one
};

struct StepCurve {
  std::string name;  ///< EYX
  std::size_t axis = 0;
  bool known = true;  ///< positioning: false if less its end line, as the scale is not known
  std::vector<double> position, value, u;  ///< m
  std::vector<Shares> shares;
};

/// An axis series against the positioning that the diagonals alone give, both less a line.
struct ShapeContrast {
  std::size_t axis = 0;
  double rms = 0.0, largest = 0.0, at = 0.0;  ///< m
  double p = 1.0;
};

struct StepSolution {
  std::array<StepCurve, 9> curves;      ///< EXX EYX EZX EXY EYY EZY EXZ EYZ EZZ
  std::array<Estimated, 3> squareness;  ///< C0Y, B0Z, A0Z, rad
  std::size_t unknowns = 0, rank = 0;   ///< function values and set-up angles; 9n + 8 at most known
  double u_reading = 0.0;               ///< m, as used
  double dof = 0.0;                     ///< of u_reading from the residuals
  /// Set-up angle of each pass, rad; empty if it is not separable from the scales.
  std::vector<double> set_up;
  std::vector<ShapeContrast> shapes;  ///< of each series
  bool scales_known() const { return curves[0].known && curves[4].known && curves[8].known; }
};

/// An error if a function cannot be known, as too many readings are missing. The lines of the
/// model, if there is one, are the passes, each with its zero before the 3n readings, and the
/// series.
Expected<StepSolution> solve_step_diagonals(const StepDiagonals&, const std::vector<AxisSeries>&,
                                            const StepChoices&, const ReadingModel* = nullptr);
/// Needs every reading. The lines of the model are the passes.
Expected<StepSolution> average_step_diagonals(const StepDiagonals&, const StepChoices&,
                                              const ReadingModel* = nullptr);

/// What the check sums show.
struct StepChecks {
  std::array<double, 3> constant{};  ///< mean check sum of the moves of X, Y, Z, m
  double p_constant = 1.0;           ///< of the most significant one, times 3
  double trend = 0.0;                ///< from step to step, m
  double p_trend = 1.0;
  double u_reading = 0.0;  ///< from their scatter, m
  std::size_t count = 0;
};
StepChecks check_step_diagonals(const StepDiagonals&);

/// Mean total of the diagonals less the prediction of three axis series (ascending), m: mean D -
/// sum of (T_a/L) E_aa(T_a). Nothing if an axis or a total is missing.
std::optional<Estimated> close_lengths(const StepDiagonals&, const std::vector<AxisSeries>&,
                                       double u_reading);

}  // namespace nonio::math
