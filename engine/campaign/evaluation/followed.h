// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/other_targets.h"
#include "campaign/reading/campaign_reader.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/results.h"

namespace nonio::evaluation {

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
