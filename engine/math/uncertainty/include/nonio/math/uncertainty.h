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
/// known to be within a full range r contributes 0.6 r (2/(2 sqrt 3) = 0.577, rounded up):
///
///     U_DEV = U_fixed + U_per_length L         L: first target to last, m
///     U_MIS = 0.6 R_mis^2/(2 L)                R_mis: misalignment, m
///     U_M   = 0.6 alpha L R(theta)             alpha: expansion, 1/K; R(theta): K
///     U_E   = 0.6 dT L R(alpha)                dT: largest distance from 20 degC, K
///     U_EVE = 0.6 E_VE                         E_VE: range of the drift test, m or rad
///     U_MD, U_ED: U_M and U_E of a device with a length of its own
///
/// Source: names of ISO/TR 230-9:2005 Annex C and ISO 230-2:2006 Annex A, whose texts were not
/// available (docs/uncertainty.md, M).
struct Budget {
  double U_DEV = 0.0;
  double U_MIS = 0.0;
  double U_M = 0.0;
  double U_E = 0.0;
  double U_MD = 0.0;
  double U_ED = 0.0;
  double U_EVE = 0.0;
  double length = 0.0;  ///< measured length to which the contributions apply, m or rad
  bool rotary = false;  ///< if true, only U_DEV and U_EVE exist
  /// contributions of drift and repetition that these readings do not exclude; 0 if U_EVE is 0
  DriftShare seen;
  /// S: root of the sum of squares of all except U_EVE, which do not average out over approaches.
  double systematic() const;
};

struct BudgetOrGap {
  std::optional<Budget> budget;
  std::vector<std::string> missing;  ///< manifest keys that the budget requires
};

/// Returns the budget, or the keys that are missing for it. `environment`: that of the campaign, or
/// as extended by the readings (limits_held).
BudgetOrGap uncertainty_budget(const Campaign&, const Environment&, const std::string& axis,
                               const AxisTest&);

/// The budget has no results.
UncertaintyBudget contributions_of(const Budget&, const std::string& axis, bool rotary);
/// Expanded uncertainty (k = 2) of a result, and the part of it by drift and repetition (`seen`).
struct ResultUncertainty {
  double U = 0.0, of_readings = 0.0;
  operator double() const { return U; }  // NOLINT(google-explicit-constructor)
};
/// Standard uncertainties in a result. `systematic`: the result contains the contributions that do
/// not average out (A, E, M, P, Pa); otherwise only environment and readings contribute.
std::vector<double> shares_of(const Budget&, const ResultUncertainty&, bool systematic);

/// Smallest number of readings in a mean, over targets and directions with readings; 0 without
/// readings.
std::size_t approaches_per_mean(const AxisTest&);

/// Expanded uncertainties (k = 2) of the results of ISO 230-2; m or rad. n: approaches in each
/// mean, at least 1; k: coverage factor of R and A in the edition.
///
///     U(B)^2 = 2 U_EVE^2/n + D_B^2          U(R+)^2 = U(R-)^2 = (k U_EVE)^2 + (2 k D_s)^2
///     U(B_mean)^2 = 2 U_EVE^2/n + D_mean^2  U(R)^2 = U(R+)^2 + U(B)^2
///     U(M)^2 = S^2 + U_EVE^2/n + D_M^2      U(A) = U(A+) = U(A-) = sqrt(U(E)^2 + (k U_EVE)^2)
///     U(E)^2 = U(E+)^2 = U(E-)^2 = S^2 + 2 U_EVE^2/n + D_E^2
///
/// D: contributions of drift and repetition that the readings do not exclude (drift.h). s in A and
/// R is that of the runs of the test: how well it estimates the axis is not in U. Derived according
/// to the GUM (docs/uncertainty.md, confidence L): compare with the standard before claiming
/// conformity to it.
struct Iso230Uncertainty {
  ResultUncertainty A, A_plus, A_minus, E, E_plus, E_minus, M, R, R_plus, R_minus, B, B_mean;
};
Iso230Uncertainty iso230_2_uncertainty(const Budget&, std::size_t n, double k);

/// Expanded uncertainties of the results of VDI/DGQ 3441, which contains no rule for them. They are
/// derived according to the GUM from those of ISO 230-2 with k = 3.
///
///     U(Pa) = U(M)    U(U_max) = U(B)    U(Ps_max) = U(Ps_mean) = U(R+)    U(P) = U(A)
///     U(U_mean) = U(B_mean) if all reversals have one sign, otherwise U(B)
struct VdiUncertainty {
  ResultUncertainty P, Pa, Ps_max, Ps_mean, U_max, U_mean;
};
VdiUncertainty vdi3441_uncertainty(const Budget&, std::size_t n);

/// Returns the expanded uncertainty (k = 2) of a value of any rule of positioning (positioning.h),
/// derived according to the GUM. The members of RuleShare are its coefficients:
///
///     U^2 = means U_EVE^2/n + (scatter U_EVE)^2 + band E_VE^2 + (seen_factor D)^2
///           + S^2 if `systematic`, otherwise + (2 scatter D_s)^2
///
/// E_VE = U_EVE/0.6 limits the error of a difference of two readings.
ResultUncertainty rule_uncertainty(const Budget&, std::size_t n, const RuleShare&);

/// U(M)/L of `slope_budget`, an upper bound for the slope of a least-squares line of means.
ResultUncertainty slope_uncertainty(const Budget& of_slope, std::size_t n);
/// A misaligned beam makes every distance too short. In a slope its limit acts from one side, so it
/// contributes 2/sqrt 3 of the limit instead of 0.6.
Budget slope_budget(const Budget&);

/// Returns the standard uncertainty of the scale of an axis that all readings of a test over `length`
/// have in common: instrument, misalignment and temperatures; std::nullopt if a key is missing.
std::optional<double> common_scale_uncertainty(const Campaign&, const std::string& axis,
                                               double length);

}  // namespace nonio::math
