// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/units.h"

namespace nonio::math {
class AxisTest;
struct OtherTargets;
}  // namespace nonio::math

namespace nonio::evaluation {

/// Data for comparison with campaigns that have other targets (nonio/math/followed.h).
struct ComparedTargets {
  struct Fit {
    double beyond = 0.0, dof = 0.0;
    std::vector<double> coefficients{}, covariance{}, share{};
    std::vector<double> sinusoids{};  ///< value, variance and share of each sinusoid (SI units)
    std::vector<double> residuals{};  ///< residual at each target, m or rad
  };

  /// Digest of the targets, rounded to 1 um or 0.001 deg.
  std::uint64_t digest = 0;
  double from = 0.0, to = 0.0;
  bool rotary = false;
  std::vector<double> of_readings{}, share{};
  Fit mean{}, reversal{};
};

ComparedTargets compared_targets(const nonio::math::AxisTest&, const nonio::math::OtherTargets&);

/// `variances`: squares of u, SI units.
void put_other_targets(JsonWriter& json, const ComparedTargets&,
                       const std::vector<Quantity>& quantities,
                       const std::vector<double>& variances);

}  // namespace nonio::evaluation
