// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/units.h"

/// What of one campaign is followed over the campaigns of a machine: quantities that are linear in
/// the readings. Unlike a largest deviation they do not grow with the number of targets and runs.
///
/// With m_i the mean deviation at target x_i, both directions averaged, B_i the mean from the +
/// less that from the - direction, and z = 2 (x - middle)/length:
///
///     scale        slope of the line through (x_i, m_i)
///     curve_2, _3  coefficients of the Legendre polynomials P2(z), P3(z) next to 1 and z: the part
///                  of the deviation at the axis' ends
///     cyclic_cos,  coefficients of cos and sin of 2 pi x/period with those four (two numbers,
///     cyclic_sin   not an amplitude, which scatter makes larger)
///     turn_cos,    the same of one turn of a rotary axis
///     turn_sin
///     B_mean       mean of B_i
///     ln_s         ln of the root of the mean of s_i^2 over targets and directions
///                  (s in um or arcsec)
///
/// Each is f = sum J_k y_k over the readings (ln_s aside). Its uncertainty u is of what is new in
/// each campaign. Of the readings: with e of a single reading, and of each run the offset and slope
/// that its two passes share (s) and that they do not (d),
///
///     u^2 = sum_dir v_dir sum J_k^2 + sum_runs (v_s (G+ + G-)^2 + v_d (G+ - G-)^2 + slopes alike)
///
/// Where readings of neighbouring targets are alike (their correlation r is estimated), r^|k - l|
/// joins the readings of a pass in the first sum. G: sum of J_k over a pass, of J_k (x_k - middle)
/// for slopes. v_s, v_d: variance of the offsets over the runs less what single readings make of
/// it; not below 0. For the scale also, from the manifest: misalignment, temperature reading, and
/// expansion where the temperature is not in the file (docs/formulas.md). What campaigns share is
/// apart: an error of the instrument's length, and of the expansion coefficient. Sources: JCGM
/// 100:2008, 5.2; variance components by the analysis of variance (derived), checked by simulation
/// (tests/unit/math/followed_test.cpp).
namespace nonio::math {

struct Followed {
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0;  ///< standard uncertainty of what is new in each campaign
  /// What one standard uncertainty makes of it, signed: of the instrument's length, and of the
  /// axis' expansion coefficient.
  double of_instrument = 0.0, of_expansion = 0.0;
};

/// A fit to values at targets, for a comparison with campaigns that have other targets: a polynomial
/// in z, P0 .. Pd, and the sinusoids that are followed.
struct TargetFit {
  /// Variance of the values about the fit beyond what the readings make of it: what a machine has
  /// between its targets. Below 0 by chance; m^2 or rad^2.
  double beyond = 0.0;
  double dof = 0.0;                 ///< degrees of freedom of `beyond`
  std::vector<double> residuals{};  ///< of the values, by target; m or rad
  /// Of P0 .. Pd. None of a rotary axis, whose quantities do not refer to its ends.
  std::vector<double> coefficients{};
  /// Between them, row by row: what the readings make of them, and what independent values with
  /// variance 1 at the targets make of them.
  std::vector<double> covariance{}, share{};
  /// Of cos and sin of each sinusoid, with these two variances.
  struct Sinusoid {
    double value = 0.0, variance = 0.0, share = 0.0;
  };
  std::vector<Sinusoid> sinusoids{};
};

/// What a comparison with campaigns that have other targets needs. The quantities are functions of
/// values at the targets, so another choice of targets makes other values of the same machine, with
/// the variance `share` times `beyond` of the fit.
struct OtherTargets {
  /// Of each quantity but ln_s: variance of the readings alone, and sum of t_i^2 over the targets
  /// (of B_mean with `reversal`, of the others with `mean`).
  std::vector<double> of_readings{}, share{};
  TargetFit mean{}, reversal{};
};

struct FollowedAxis {
  std::vector<Followed> quantities;
  /// Of `u`, between quantities i and j at i * n + j; SI.
  std::vector<double> covariance;
  /// Keys of the manifest that are not stated: `u` of scale lacks their contributions.
  std::vector<std::string> not_stated;
  OtherTargets other_targets{};
};

enum class Across : bool { no, yes };  ///< deviations across the axis: a straightness

/// No errors. Of fewer than two runs or three targets nothing is followed. material: mean
/// temperature of the machine during the test, degC, where the file has it.
FollowedAxis followed_quantities(const AxisTest&, const Campaign&, const std::string& axis,
                                 std::optional<double> material, Across = Across::no);

}  // namespace nonio::math
