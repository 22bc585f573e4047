// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

struct CheckCampaign {
  std::string date;  ///< date of the check as YYYY-MM-DD
  std::map<std::string, Artifact>
      readings;  ///< by the id of the measurement in the original campaign
  std::vector<Artifact> loaded;
  /// Axes of the loaded tables with the loaded backlash value, m or rad; empty if none was loaded.
  std::map<std::string, std::optional<double>> axes;
};

/// Writes the folder <campaign>-check next to the original campaign, with the readings, the loaded
/// tables and a manifest of these measurements alone, with purpose "check". Returns the folder. An
/// error if the folder exists or if the manifest cannot be converted by changing single lines.
Expected<std::filesystem::path> write_check_campaign(const OpenCampaign& open,
                                                     const CheckCampaign& check);

}  // namespace nonio::app
