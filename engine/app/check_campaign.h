// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

struct CheckCampaign {
  std::string axis, date;   ///< date of the check as YYYY-MM-DD
  std::string measurement;  ///< id in the original campaign
  Artifact readings;
  std::vector<Artifact> loaded;
  std::optional<double> backlash{};  ///< loaded value, m or rad; empty if none was loaded
};

/// Writes the folder <campaign>-check next to the original campaign, with the readings, the loaded
/// table and a manifest of this measurement alone, with purpose "check". Returns the folder. An
/// error if the folder exists or if the manifest cannot be converted by changing single lines.
Expected<std::filesystem::path> write_check_campaign(const OpenCampaign& open,
                                                     const CheckCampaign& check);

}  // namespace nonio::app
