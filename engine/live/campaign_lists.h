// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "live/campaign_index.h"
#include "live/service.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

/// Machines and instruments of the campaigns, from one version of the index.
struct CampaignLists {
  struct Machine {
    storage::Json json;   ///< the machine with its newest campaign
    std::string words{};  ///< searchable words of the newest campaign
    std::size_t campaigns = 0;
  };
  std::uint64_t version = 0;
  std::string stamp{};
  std::map<std::string, Machine> machines{};
  Answer instruments{}, records{};
};

/// Returns a text that changes with any file in SITE/machines.
std::string stamp_of_records(const std::filesystem::path& site);

/// Lists each machine, instrument and customer with its newest campaign and the values of this
/// campaign for forms. Machines with a record but without campaigns are included.
CampaignLists campaign_lists(const CampaignIndex& index, const std::filesystem::path& site);

}  // namespace nonio::live
