// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/budget.h"
#include "nonio/sdk/campaign.h"

namespace nonio::math {

/// Contributions to the uncertainty of a positioning test, expanded (k = 2), m or rad.
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
  /// What does not average out over the approaches.
  double systematic() const;
};

struct BudgetOrGap {
  std::optional<Budget> budget;
  std::vector<std::string> missing;  ///< manifest keys without which there is no budget
};

/// From the manifest; nothing is assumed for what it does not say. environment: the campaign's, or
/// what the readings make of it (limits_held).
BudgetOrGap uncertainty_budget(const Campaign&, const Environment&, const std::string& axis,
                               const AxisTest&);

/// The contributions as every analysis has them, without results.
UncertaintyBudget contributions_of(const Budget&, const std::string& axis, bool rotary);
/// Standard uncertainty of each of them in a result of expanded uncertainty U. systematic: the
/// parts that do not average out are in it (A, E, M, P, Pa); else the environment alone.
std::vector<double> shares_of(const Budget&, double U, bool systematic);

/// Fewest readings behind a mean: the least n over targets and directions that have readings.
std::size_t approaches_behind_means(const AxisTest&);

/// Expanded uncertainties (k = 2) of the results of ISO 230-2; m or rad. n: approaches behind each
/// mean; k: coverage factor of R and A in the edition.
struct Iso230Uncertainty {
  double A, A_plus, A_minus, E, E_plus, E_minus, M, R, R_plus, R_minus, B, B_mean;
};
Iso230Uncertainty iso230_2_uncertainty(const Budget&, std::size_t n, double k);

/// The same for VDI/DGQ 3441, which has no such clause: derived by the rules of the GUM.
struct VdiUncertainty {
  double P, Pa, Ps_max, Ps_mean, U_max, U_mean;
};
VdiUncertainty vdi3441_uncertainty(const Budget&, std::size_t n);

}  // namespace nonio::math
