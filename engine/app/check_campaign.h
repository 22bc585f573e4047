// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// The campaign that checks a loaded table, made of the one that the table was computed from.
struct CheckCampaign {
  std::string axis, date;            ///< measured; YYYY-MM-DD
  std::string measurement;           ///< id in the campaign that it is made of
  Artifact readings;                 ///< its file
  std::vector<Artifact> loaded;      ///< files of the table that is loaded
  std::optional<double> backlash{};  ///< that is loaded, m or rad
};

/// Writes the folder <folder of the campaign>-check next to it: the same manifest with the one
/// measurement, purpose "check", the day and the loaded table. Gives the folder. An error if it
/// exists, or if the manifest has a form in which this cannot be stated by changing single lines.
Expected<std::filesystem::path> write_check_campaign(const OpenCampaign& open,
                                                     const CheckCampaign& check);

}  // namespace nonio::app
