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
  std::string measurement;  ///< id of the measurement; empty: the whole campaign
  std::string axis;         ///< name of the axis in the control; X1 and X2 of a gantry are two axes
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0;  ///< standard uncertainty of the part that is new in each campaign
  std::vector<Common> common{};
  std::string state{};  ///< as-found or as-left; empty: not stated
  /// Conditions that must be equal for campaigns to be comparable; numbers in printed units.
  std::vector<std::pair<std::string, double>> numbers{};
  std::vector<std::pair<std::string, std::string>> texts{};
  /// Keys that are not stated; `u` does not include their contribution.
  std::vector<std::string> not_stated{};
};

/// Quantities that were estimated together, and the covariance matrix of their parts that are new
/// in each campaign, row by row in SI units.
struct FollowedGroup {
  std::vector<FollowedQuantity> quantities;
  std::vector<double> covariance;
  /// Data for the comparison with other targets; none unless the quantities are computed from
  /// values at targets.
  std::optional<ComparedTargets> targets{};
};

/// Returns the quantities of all results that are compared between campaigns. Measurements without
/// an uncertainty are left out.
std::vector<FollowedGroup> followed_of(const reading::ReadCampaign& read, const Results& results);

/// Writes the members `followed` and `followed_covariance` of results.json.
void put_followed(JsonWriter& json, const std::vector<FollowedGroup>& groups);

}  // namespace nonio::evaluation
