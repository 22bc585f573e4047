// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/sdk/error.h"

/// Squareness and straightness of two axes from the diagonals of their rectangle.
///
/// Symbols (ISO 230-1; lengths in m, angles in rad). Travels Lx, Ly; L = hypot(Lx, Ly); c = Lx/L,
/// s = Ly/L; n equal steps, x_i = i Lx/n, y_i = i Ly/n. f_i = EYX(x_i), g_i = EXY(y_i), both 0 at
/// both ends (end-point gauge; their slopes are then part of k), k = C0Y, positive turns +Y towards
/// -X. Ex(x, y): positioning error of X on the line y, EXX(x) - (y - y0) ECX(x). A line of
/// measurement has stops (x_a, y_b) on the grid and a direction (cx, cy); it reads, from its first
/// stop on,
///
///     D = cx [Ex(x_a, y_b) + g_b - k y_b] + cy [f_a + EYY(y_b)]  less the same at the first stop.
///
/// With positioning on one line and yaw by another instrument (mirror and autocollimator), ECX is
/// that; with positioning on two lines it is (EXX_1 - EXX_2)/(y_2 - y_1).
///
/// A line that was read from one direction only goes with positioning in the directions in which
/// its axes moved.
///
/// First-order form of the product of the transforms of both carriages (Schwenke et al., CIRP
/// Annals 57 (2008) 660); tests compare it with the exact product. What two full diagonals leave
/// open is EXY = a, EYX = -(Lx/Ly) a for every a that is odd about mid-travel: floor((n - 1)/2)
/// numbers. Derived here; docs/formulas.md.
namespace nonio::math {

/// Means of readings, and the standard uncertainty of each mean.
struct MeanCurve {
  std::vector<double> mean;
  double u = 0.0;         ///< 0: not known
  double dof = INFINITY;  ///< of u
  /// The first stop was not read, or the instrument was set to zero there each time: 0 by
  /// definition.
  bool zeroed = true;
  int direction = 0;                        ///< of approach: +1, -1; 0: mean of both
  std::vector<BudgetLine::Visit> visits{};  ///< what the means were made of, by time; or none
  double walk_seen = 0.0;                   ///< of u^2, by a walk of variance 1 along the line
};

struct PitchLine : MeanCurve {
  double across = 0.0;  ///< position of the other axis on this line, m from the grid's origin
};

/// Readings along a straight line whose stops are points of the grid.
struct GridLine : MeanCurve {
  std::vector<std::size_t> ix, iy;       ///< of each stop
  double cx = 0.0, cy = 0.0;             ///< unit vector of sensing
  int x_direction = 0, y_direction = 0;  ///< of approach, as in MeanCurve
};

/// Straightness by another instrument, against a line that is its own.
struct DirectStraightness : MeanCurve {
  /// The even part is used too, with a line through both ends (`zeroed`: readings that are 0 by
  /// definition). Else only the odd part, and the slope of the line is unknown.
  bool whole = false;
  /// The same line after the straightedge was turned over: the mean of both counts, and what is
  /// the straightedge's own drops out. Deviations in the same sense.
  std::optional<MeanCurve> reversed{};
  /// Readings that it has: of one curve or of both.
  std::size_t readings() const { return mean.size() + (reversed ? reversed->mean.size() : 0); }
  double mean_of(std::size_t i) const {
    return reversed ? (mean[i] + reversed->mean[i]) / 2.0 : mean[i];
  }
};

/// Everything read at the same n + 1 points of each axis. Curves of pitch and straightness have
/// n + 1 means.
struct DiagonalReadings {
  double Lx = 0.0, Ly = 0.0;
  std::size_t n = 0;
  GridLine D1, D2;              ///< (0, 0) -> (Lx, Ly), (0, Ly) -> (Lx, 0)
  std::vector<GridLine> third;  ///< further lines, which may close what the two leave open
  /// Positioning of X on one line, or on two: then with yaw; and of Y. Of each direction of
  /// approach in which lines were read.
  std::vector<PitchLine> X, Y;
  std::vector<MeanCurve> ECX;  ///< yaw, rad, of each direction; counts where X has one line
  std::optional<DirectStraightness> EYX, EXY;
};

/// A curve over n + 1 points with its standard uncertainty at each: of the repetition, and of the
/// inputs of a ReadingModel, if there was one.
struct KnownCurve {
  std::vector<double> value, u;
  std::vector<Shares> shares;
  double gain = 0.0;  ///< rms over the inner points of u for white noise 1 of the readings of lines
};

/// Least-squares line of ISO 230-1 taken out.
struct LsqGauge {
  KnownCurve EYX, EXY;  ///< empty if they cannot be separated
  double C0Y = 0.0, u_C0Y = 0.0;
  Shares shares_C0Y;
};

struct Closure {
  double S_n = 0.0, S_n_limit = 0.0;      ///< 4 standard uncertainties
  double S_odd = 0.0, S_odd_limit = 0.0;  ///< rms, and 4 times what noise gives
  bool passed() const { return std_abs(S_n) <= S_n_limit && S_odd <= S_odd_limit; }

 private:
  static double std_abs(double v) { return v < 0.0 ? -v : v; }
};

/// The even part of a straightness measured directly against that of the diagonals, which does not
/// use it: chi2 = d' V^-1 d with the covariance V of all readings and inputs, F = chi2/dof.
struct Agreement {
  std::vector<double> difference,
      u;  ///< direct less diagonals at the inner points up to mid-travel
  double chi2 = 0.0, p = 1.0;
  std::size_t worst = 0;  ///< point of the grid with the largest difference in terms of its u
};

struct DiagonalResult {
  double C0Y = 0.0, u_C0Y = 0.0, gain_C0Y = 0.0;  ///< end-point gauge; gain in 1/m
  Shares shares_C0Y;
  std::size_t unknowns = 0, rank = 0;
  std::size_t nullity() const { return unknowns - rank; }
  bool separable() const { return rank == unknowns; }
  KnownCurve EYX, EXY;                   ///< if separable, else empty; end-point gauge
  KnownCurve EYX_even, EXY_even, q_odd;  ///< always; q = c EXY + s EYX
  LsqGauge lsq;
  std::vector<double> d1, d2;         ///< readings less positioning and yaw
  KnownCurve ECX;                     ///< yaw as it was subtracted; empty if there was none
  std::optional<double> slave_shift;  ///< of the second line's zero, removes C0Y; from two lines
  /// Range of the second line of X less the first, m: how far the sides run apart over the travel.
  struct Racking {
    double value = 0.0, u = 0.0;
    std::size_t high = 0, low = 0;  ///< points of the grid
    Shares shares;
  };
  std::optional<Racking> racking;  ///< from two lines
  Closure closure;
  /// Of a direct straightness that is not whole, with a model of the readings.
  std::optional<Agreement> EYX_agrees, EXY_agrees;
  /// Standard deviation of a mean as the residuals of the fit predict, with its degrees of freedom.
  double residual_u = 0.0;
  std::size_t dof = 0;
  bool noise_known = false;  ///< every u was given: else all are taken as equal, from residual_u
};

/// Fails if the curves do not have the lengths that the grid requests. The lines of the model, if
/// there is one, are Y, X, ECX, D1, D2, the third lines, EYX, EXY, a reading for each mean; after a
/// straightness the one with the straightedge turned over.
Expected<DiagonalResult> solve_diagonals(const DiagonalReadings&, const ReadingModel* = nullptr);

/// What a bound abs(EXY_odd) <= G (m) implies for EYX_odd = (q_odd - c EXY_odd)/s: EYX_even +
/// (q_odd -+ c G)/s at each stop, m. Derived, docs/formulas.md.
struct Band {
  std::vector<double> low, high;
};
Band straightness_band(const DiagonalResult&, double Lx, double Ly, double G);

/// 1/(2 min(c, s)): scatter of the worse straightness for scatter 1 of a diagonal's reading.
/// c = Lx/L, s = Ly/L; Lx, Ly > 0.
double diagonal_gain(double Lx, double Ly);

}  // namespace nonio::math
