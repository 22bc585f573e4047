// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/reading/campaign_reader.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/results.h"
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

/// A quantity of a campaign that is compared between the campaigns of its machine
/// (nonio/math/followed.h).
struct FollowedQuantity {
  /// Signed standard uncertainty that campaigns with the same source have in common.
  struct Common {
    std::string source;
    double u = 0.0;
  };
  std::string measurement;  ///< empty for a quantity of the whole campaign
  std::string axis;         ///< name in the control; X1 and X2 of a gantry are two axes
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0;  ///< standard uncertainty of the part that is new in each campaign
  std::vector<Common> common{};
  std::string state{};  ///< "as-found" or "as-left"; empty if not stated
  /// Conditions that must be equal in comparable campaigns, in printed units.
  std::vector<std::pair<std::string, double>> numbers{};
  std::vector<std::pair<std::string, std::string>> texts{};
  /// Keys that are not stated; `u` does not include their contribution.
  std::vector<std::string> not_stated{};
};

/// `covariance`: of the parts that are new in each campaign, row by row, SI units.
struct FollowedGroup {
  std::vector<FollowedQuantity> quantities;
  std::vector<double> covariance;
  /// For the comparison with other targets; nullopt unless the quantities come from targets.
  std::optional<ComparedTargets> targets{};
};

/// Measurements without an uncertainty are left out.
std::vector<FollowedGroup> followed_of(const reading::ReadCampaign& read, const Results& results);

void put_followed(JsonWriter& json, const std::vector<FollowedGroup>& groups);

}  // namespace nonio::evaluation
