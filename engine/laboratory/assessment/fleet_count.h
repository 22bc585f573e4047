// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "campaign/config/fleet.h"
#include "nonio/sdk/error.h"

namespace nonio::assessment {

/// Counts the effects in the results of campaigns: those of the model that are significant, and the
/// one that is missing from it, unless another one explains the readings equally well.
class FleetCount {
 public:
  /// `results`: results.json of a campaign. Campaigns without a search of effects do not count.
  Expected<void> add(std::string_view results);
  config::Fleet fleet(const std::string& today) const;

 private:
  struct Effect {
    std::vector<std::string> found;
    std::map<std::string, std::vector<double>> sizes;  // by unit
  };
  struct Machines {
    std::vector<std::string> campaigns;
    std::map<std::string, Effect> effects;
  };
  std::map<std::pair<std::string, std::string>, Machines> machines_;  // by maker and model
  std::string from_, until_;
};

}  // namespace nonio::assessment
