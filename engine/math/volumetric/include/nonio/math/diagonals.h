// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/sdk/error.h"

/// Squareness and straightness of two axes from the diagonals of their rectangle.
///
/// Symbols (ISO 230-1; lengths in m, angles in rad). Travels Lx, Ly; L = hypot(Lx, Ly); c = Lx/L, s
/// = Ly/L; n equal steps, x_i = i Lx/n, y_i = i Ly/n. f_i = EYX(x_i), g_i = EXY(y_i), both 0 at
/// both ends (end-point gauge; their slopes are then part of k), k = C0Y, positive turns +Y toward
/// -X. Ex(x, y): positioning error of X on the line y, EXX(x) - (y - y0) ECX(x). A line of
/// measurement has stops (x_a, y_b) on the grid and a direction (cx, cy); its reading is
///
///     D = cx [Ex(x_a, y_b) + g_b - k y_b] + cy [f_a + EYY(y_b)] minus the same at the first stop
///
/// ECX is yaw measured by another instrument, or with positioning on two lines (EXX_1 - EXX_2)/(y_2
/// - y_1). A line that was read from one direction only is evaluated with the positioning in the
/// directions in which its axes moved. First-order form of the product of the transforms of both
/// carriages (Schwenke et al., CIRP Annals 57 (2008) 660). Two full diagonals do not determine EXY
/// = a, EYX = -(Lx/Ly) a for every a that is odd about mid-travel (docs/dev/estimators.md).
namespace nonio::math {

struct MeanCurve {
  std::vector<double> mean;
  double u = 0.0;  ///< standard uncertainty of each mean; 0: not known
  double dof = INFINITY;
  /// Whether the mean at the first stop is 0 by definition: it was not read, or set to zero.
  bool zeroed = true;
  int direction = 0;                        ///< direction of approach: +1, -1; 0: mean of both
  std::vector<BudgetLine::Visit> visits{};  ///< visits that contribute to the means, sorted by time
  double walk_seen = 0.0;  ///< contribution to u^2 of a random walk with variance 1 along the line
};

struct PitchLine : MeanCurve {
  double across = 0.0;  ///< position of the other axis on this line, m from the grid's origin
};

/// Readings along a straight line whose stops are points of the grid.
struct GridLine : MeanCurve {
  std::vector<std::size_t> ix, iy;       ///< grid indices of each stop
  double cx = 0.0, cy = 0.0;             ///< direction of sensing, unit vector
  int x_direction = 0, y_direction = 0;  ///< direction of approach of each axis, as in MeanCurve
};

/// Straightness measured by another instrument, relative to a reference line of its own.
struct DirectStraightness : MeanCurve {
  /// true: the even part is used too, relative to a line through both ends. false: only the odd
  /// part is used, because the slope of the reference line is unknown.
  bool whole = false;
  /// Curve of this line with the straightedge turned over, with equal signs: the mean of both
  /// curves is used, in which the error of the straightedge cancels.
  std::optional<MeanCurve> reversed{};
  std::size_t readings() const { return mean.size() + (reversed ? reversed->mean.size() : 0); }
  double mean_of(std::size_t i) const {
    return reversed ? (mean[i] + reversed->mean[i]) / 2.0 : mean[i];
  }
};

/// Curves of positioning, yaw and straightness have means at the same n + 1 points.
struct DiagonalReadings {
  double Lx = 0.0, Ly = 0.0;
  std::size_t n = 0;
  GridLine D1, D2;              ///< diagonals from (0, 0) to (Lx, Ly), and from (0, Ly) to (Lx, 0)
  std::vector<GridLine> third;  ///< further lines, which may determine what two diagonals do not
  /// Positioning for each direction of approach of the lines; two lines of X determine yaw.
  std::vector<PitchLine> X, Y;
  std::vector<MeanCurve> ECX;  ///< yaw, rad, of each direction; used if X has one line
  std::optional<DirectStraightness> EYX, EXY;
};

/// A curve over n + 1 points, with u by repetition; `shares` is empty without a ReadingModel.
struct KnownCurve {
  std::vector<double> value, u;
  std::vector<Shares> shares;
  /// rms of u over the inner points for noise of 1 in the readings of lines and straightness
  double gain = 0.0;
};

/// Results relative to the least-squares reference line of ISO 230-1.
struct LsqGauge {
  KnownCurve EYX, EXY;  ///< empty if they are not separable
  double C0Y = 0.0, u_C0Y = 0.0;
  Shares shares_C0Y;
};

struct Closure {
  double S_n = 0.0, S_n_limit = 0.0;  ///< closure error at the end; limit: 4 standard uncertainties
  /// rms of the odd part of the closure error; limit: 4 times its expected value by noise
  double S_odd = 0.0, S_odd_limit = 0.0;
  bool passed() const { return std_abs(S_n) <= S_n_limit && S_odd <= S_odd_limit; }

 private:
  static double std_abs(double v) { return v < 0.0 ? -v : v; }
};

/// Compares the even part of a measured straightness with that from the diagonals alone: chi2 = d'
/// V^-1 d with the covariance V of all readings and inputs, F = chi2/dof.
struct Agreement {
  /// direct minus diagonals, at the inner points up to mid-travel; its standard uncertainty
  std::vector<double> difference, u;
  double chi2 = 0.0, p = 1.0;
  std::size_t worst = 0;  ///< grid point with the largest ratio of difference to u
};

struct DiagonalResult {
  /// squareness and its u, rad, in the end-point gauge; u for noise of 1 m, 1/m
  double C0Y = 0.0, u_C0Y = 0.0;
  Shares shares_C0Y;
  std::size_t unknowns = 0, rank = 0;
  std::size_t nullity() const { return unknowns - rank; }
  bool separable() const { return rank == unknowns; }
  KnownCurve EYX, EXY;  ///< straightnesses in the end-point gauge; empty if not separable
  KnownCurve EYX_even, EXY_even, q_odd;  ///< parts that are always determined; q = c EXY + s EYX
  LsqGauge lsq;
  std::vector<double> d1, d2;         ///< readings of the diagonals minus positioning and yaw
  KnownCurve ECX;                     ///< yaw that was subtracted; empty if none was subtracted
  std::optional<double> slave_shift;  ///< shift of the zero of the second line that removes C0Y, m
  /// Range of the difference between the second and the first line of X, m.
  struct Racking {
    double value = 0.0, u = 0.0;
    std::size_t high = 0, low = 0;  ///< grid points of its largest and smallest value
    Shares shares;
  };
  std::optional<Racking> racking;  ///< only if X was measured on two lines
  Closure closure;
  /// For a direct straightness that is not `whole`, if there is a model of the readings.
  std::optional<Agreement> EYX_agrees, EXY_agrees;
  /// Standard deviation of a mean from the residuals of the fit, m; if `noise_known`, the ratio of
  /// the residuals to their given uncertainty.
  double residual_u = 0.0;
  std::size_t dof = 0;
  bool noise_known = false;  ///< whether every u was given; otherwise residual_u is used
};

/// Errors: an invalid grid or curve, readings that do not determine what two diagonals do, a model
/// with another number of readings. Lines of the model, with one reading for each mean: Y, X, ECX,
/// D1, D2, the third lines, EYX, EXY; each straightness is followed by the one with the
/// straightedge turned over.
Expected<DiagonalResult> solve_diagonals(const DiagonalReadings&, const ReadingModel* = nullptr);

/// Bounds of EYX, m, from a bound abs(EXY_odd) <= G, m: EYX_even + (q_odd -+ c G)/s at each stop.
/// They are equal at both ends and at mid-travel (odd part 0). Derived (docs/dev/estimators.md).
struct Band {
  std::vector<double> low, high;
};
Band straightness_band(const DiagonalResult&, double Lx, double Ly, double G);

/// Returns 1/(2 min(Lx, Ly)/L): scatter of the worse straightness for scatter 1 of a reading.
double diagonal_gain(double Lx, double Ly);

}  // namespace nonio::math
