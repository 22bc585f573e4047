// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

namespace nonio::math {

/// Decides conformity to an upper limit. The default, also for an empty `rule`, is ISO 14253-1:2017
/// with at least 95 %: guard band 1.65 u on both sides, or 0.825 U if k > 2 (few degrees of freedom). "iso14253-1:2013" has a
/// guard band U on both sides; ILAC-G8:09/2019 has simple acceptance (4.2.1) and a guard band U
/// (4.2.2). Indeterminate without a finite value and U.
Decision decide(double value, double U, double tolerance, std::string_view rule = "iso14253-1",
                double k = 2.0);

/// Guard band of `rule` for U with coverage factor k.
double guard_band(double U, std::string_view rule, double k);

/// Largest range of positions of a linear and of a rotary axis, m and rad; 0: none was measured.
struct Ranges {
  double length = 0.0, angle = 0.0;
};

/// Smallest U (k = 2) that the accreditation covers over `length` (m), SI, of a slope that of the
/// ends divided by the measured range; 0 without accreditation or if [laboratory.cmc] states nothing
/// for this quantity. An analysis that decides itself uses at least this U, because the result gets
/// it too.
double least_U(const Laboratory& laboratory, Quantity quantity, double length,
               const Ranges& measured = {});

}  // namespace nonio::math
