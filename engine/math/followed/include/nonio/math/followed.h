// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/units.h"

/// Followed quantities: results of one campaign that are compared with those of other campaigns of
/// the same machine, to detect changes. They are linear in the readings, so that, unlike a largest
/// deviation, they do not grow with the number of targets and runs.
///
/// With m_i the mean deviation at target x_i, both directions averaged, B_i the mean from the +
/// direction minus that from the - direction, and z = 2 (x - middle)/length:
///
///     scale        slope of the line through (x_i, m_i)
///     curve_2, _3  coefficients of the Legendre polynomials P2(z), P3(z), fitted with 1 and z:
///                  each is the value of its term at the end z = 1
///     cyclic_cos,  coefficients of cos and sin of 2 pi x/period, fitted with those four (two
///     cyclic_sin   numbers, not an amplitude, which scatter would increase)
///     turn_cos,    coefficients of one sinusoid per turn of a rotary axis
///     turn_sin
///     B_mean       mean of B_i
///     ln_s         ln of the root of the mean of s_i^2 over targets and directions
///                  (s in um or arcsec)
///
/// Each is f = sum J_k y_k over the readings (except ln_s). Its uncertainty u covers contributions
/// that are new in each campaign. From the readings: with e the error of a single reading, and for
/// each run the offset and slope that its two passes share (s) and that they do not (d),
///
///     u^2 = sum_dir v_dir sum J_k^2 + sum_runs (v_s (G+ + G-)^2 + v_d (G+ - G-)^2 + two more terms
///           of this form for the slopes)
///
/// If readings of adjacent targets are correlated (their correlation r is estimated), the first sum
/// includes r^|k - l| between the readings of a pass. G: sum of J_k over a pass, of J_k (x_k -
/// middle) for slopes. v_s, v_d: variance of the offsets over the runs minus the contribution of
/// single readings to it; not below 0. For the scale also, from the manifest: misalignment,
/// temperature reading, and expansion if the file does not contain the temperature. Contributions
/// shared by campaigns are separate: the error of the length of the instrument, and that of the
/// expansion coefficient. Sources: JCGM 100:2008, 5.2; variance components by the analysis of
/// variance (derived).
namespace nonio::math {

struct Followed {
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0;  ///< standard uncertainty by contributions that are new in each campaign
  /// Signed change of `value` for one standard uncertainty of the instrument's length scale, and of
  /// the expansion coefficient of the axis.
  double of_instrument = 0.0, of_expansion = 0.0;
};

/// A fit to values at targets, for a comparison with campaigns that have other targets: a
/// polynomial P0 .. Pd in z, and the followed sinusoids.
struct TargetFit {
  /// Variance of the values about the fit minus the contribution of the readings, m^2 or rad^2; it
  /// can be below 0 by chance.
  double beyond = 0.0;
  double dof = 0.0;
  std::vector<double> residuals{};  ///< residual of the value at each target; m or rad
  /// Coefficients of P0 .. Pd. Empty for a rotary axis, whose quantities do not refer to its ends.
  std::vector<double> coefficients{};
  /// Covariance matrices of the coefficients, row by row: from the readings, and from independent
  /// values with variance 1 at the targets.
  std::vector<double> covariance{}, share{};
  /// `variance`: by the readings; `share`: by independent values of variance 1 at the targets.
  struct Sinusoid {
    double value = 0.0, variance = 0.0, share = 0.0;
  };
  std::vector<Sinusoid> sinusoids{};
};

/// The choice of targets adds the variance `share` times `beyond` of the fit to each quantity.
struct OtherTargets {
  /// For each quantity except ln_s: variance from the readings alone, and sum of the squared target
  /// weights t_i^2 (for B_mean used with `reversal`, for the others with `mean`).
  std::vector<double> of_readings{}, share{};
  TargetFit mean{}, reversal{};
};

struct FollowedAxis {
  std::vector<Followed> quantities;
  /// Covariance of the errors of quantities i and j (see `Followed::u`), at i * n + j; SI.
  std::vector<double> covariance;
  /// Manifest keys without a value, whose contributions are missing in `u` of scale.
  std::vector<std::string> not_stated;
  OtherTargets other_targets{};
};

enum class Across : bool { no, yes };  ///< yes: deviations across the axis, a straightness

/// The result is empty with fewer than two complete runs or three targets, or if the readings do
/// not scatter. Curves need five targets and sinusoids ten. `material`: mean temperature of the
/// machine during the test, degC, if the file contains it.
FollowedAxis followed_quantities(const AxisTest&, const Campaign&, const std::string& axis,
                                 std::optional<double> material, Across = Across::no);

}  // namespace nonio::math
