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

/// One quantity of a campaign that is followed over the campaigns of its machine
/// (nonio/math/followed.h).
struct FollowedQuantity {
  /// Standard uncertainty, signed, that other campaigns with the same source have with it.
  struct Common {
    std::string source;
    double u = 0.0;
  };
  std::string measurement;  ///< empty: of the campaign
  std::string axis;         ///< of the control; X1 and X2 of a gantry are two
  std::string name;
  double value = 0.0;
  Quantity quantity = Quantity::deviation;
  double u = 0.0;  ///< standard uncertainty of what is new in each campaign
  std::vector<Common> common{};
  std::string state{};  ///< as-found, as-left
  /// What campaigns must have alike to be compared; numbers in printed units.
  std::vector<std::pair<std::string, double>> numbers{};
  std::vector<std::pair<std::string, std::string>> texts{};
  std::vector<std::string> not_stated{};  ///< keys: `u` lacks what they would give
};

/// Quantities that were estimated together, and the covariance of their u, row by row; SI.
struct FollowedGroup {
  std::vector<FollowedQuantity> quantities;
  std::vector<double> covariance;
  /// Of quantities that are functions of values at targets.
  std::optional<ComparedTargets> targets{};
};

/// Of everything that was evaluated. Nothing of measurements without an uncertainty.
std::vector<FollowedGroup> followed_of(const reading::ReadCampaign& read, const Results& results);

/// Members `followed` and `followed_covariance` of results.json.
void put_followed(JsonWriter& json, const std::vector<FollowedGroup>& groups);

}  // namespace nonio::evaluation
