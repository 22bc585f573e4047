// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/math/drift.h"
#include "nonio/math/positioning.h"
#include "nonio/sdk/budget.h"
#include "nonio/sdk/campaign.h"

namespace nonio::math {

/// Contributions to the uncertainty of a positioning test, expanded (k = 2), m or rad. A quantity
/// known to lie within a full range r counts with 0.6 r (2/(2 sqrt 3) = 0.577, rounded up):
///
///     U_DEV = U_fixed + U_per_length L                 L: first target to last, m
///     U_MIS = 0.6 R_mis^2/(2 L)                        R_mis: misalignment, m
///     U_M   = 0.6 alpha L R(theta)                     alpha: expansion, 1/K; R(theta): K
///     U_E   = 0.6 dT L R(alpha)                        dT: largest distance from 20 degC, K
///     U_EVE = 0.6 E_VE                                 E_VE: range of the drift test, m or rad
///     U_MD, U_ED: U_M and U_E of a device with a length of its own
///
/// Source: names of ISO/TR 230-9:2005 Annex C and ISO 230-2:2006 Annex A, whose texts were not
/// available (docs/uncertainty.md, M).
struct Budget {
  double U_DEV = 0.0;   ///< measuring instrument
  double U_MIS = 0.0;   ///< its misalignment to the axis
  double U_M = 0.0;     ///< temperature of the machine as it was read
  double U_E = 0.0;     ///< expansion coefficient of the machine
  double U_MD = 0.0;    ///< temperature of a device with a length of its own
  double U_ED = 0.0;    ///< its expansion coefficient
  double U_EVE = 0.0;   ///< environmental variation, the drift test
  double length = 0.0;  ///< measured length for which they hold
  bool rotary = false;  ///< then only U_DEV and U_EVE
  DriftShare seen;      ///< what drift that these readings do not exclude makes of their values
  /// What does not average out over the approaches: S, root of the sum of squares of all but U_EVE.
  double systematic() const;
};

struct BudgetOrGap {
  std::optional<Budget> budget;
  std::vector<std::string> missing;  ///< manifest keys without which there is no budget
};

/// From the manifest; nothing is assumed for what it does not state. environment: the
/// campaign's, or what the readings make of it (limits_held).
BudgetOrGap uncertainty_budget(const Campaign&, const Environment&, const std::string& axis,
                               const AxisTest&);

/// The contributions as every analysis has them, without results.
UncertaintyBudget contributions_of(const Budget&, const std::string& axis, bool rotary);
/// Standard uncertainty of each of them in a result of expanded uncertainty U. systematic: the
/// parts that do not average out are in it (A, E, M, P, Pa); else the environment alone.
std::vector<double> shares_of(const Budget&, double U, bool systematic);

/// Fewest readings behind a mean: the least n over targets and directions that have readings.
std::size_t approaches_per_mean(const AxisTest&);

/// Expanded uncertainties (k = 2) of the results of ISO 230-2; m or rad. n: approaches behind each
/// mean, 1 or more; k: coverage factor of R and A in the edition.
///
///     U(B)^2 = 2 U_EVE^2/n + D_B^2              U(R+)^2 = U(R-)^2 = (k U_EVE)^2 + (2 k D_s)^2
///     U(B_mean)^2 = 2 U_EVE^2/n + D_mean^2      U(R)^2 = U(R+)^2 + U(B)^2
///     U(M) = sqrt(S^2 + U_EVE^2/n)              U(A) = sqrt(U(E)^2 + (k U_EVE)^2); + and - alike
///     U(E) = sqrt(S^2 + 2 U_EVE^2/n)
///
/// D_B, D_mean, D_s: of the drift that the readings do not exclude (drift.h).
///
/// Derived by the GUM (docs/uncertainty.md, L): compare with the standard before claiming it.
struct Iso230Uncertainty {
  double A, A_plus, A_minus, E, E_plus, E_minus, M, R, R_plus, R_minus, B, B_mean;
};
Iso230Uncertainty iso230_2_uncertainty(const Budget&, std::size_t n, double k);

/// The same for VDI/DGQ 3441, which has no such clause: derived by the rules of the GUM.
///
///     U(Pa) = U(M)    U(U_max) = U(U_mean) = U(B)    U(Ps_max) = U(Ps_mean) = 3 U_EVE
///     U(P) = sqrt(S^2 + 2 U_EVE^2/n + (3 U_EVE)^2)
struct VdiUncertainty {
  double P, Pa, Ps_max, Ps_mean, U_max, U_mean;
};
VdiUncertainty vdi3441_uncertainty(const Budget&, std::size_t n);

/// The same for a value of any rule of positioning (positioning.h): derived by the rules of the GUM.
///
///     U^2 = S^2 (where systematic) + means U_EVE^2/n + (scatter U_EVE)^2 + band E_VE^2
///           + D^2 of the reversal and the scatter (where not systematic)
///
/// A difference of two readings is wrong by the range of the environment E_VE = U_EVE/0.6 at most.
double rule_uncertainty(const Budget&, std::size_t n, const RuleShare&);

/// Of a slope of means over the length: U(M)/L of `slope_budget`, an upper bound for least squares.
double slope_uncertainty(const Budget& of_slope, std::size_t n);
/// A misaligned beam makes every distance too short: in a slope its limit applies from one side,
/// 2/sqrt 3 of it in place of 0.6. A range is affected less than a slope.
Budget slope_budget(const Budget&);

}  // namespace nonio::math
