// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// A campaign that checks a loaded table, based on the campaign that the table was computed from.
struct CheckCampaign {
  std::string axis, date;            ///< measured axis, and day of the check as YYYY-MM-DD
  std::string measurement;           ///< id of the measurement in the original campaign
  Artifact readings;                 ///< file of the new readings
  std::vector<Artifact> loaded;      ///< files of the loaded table
  std::optional<double> backlash{};  ///< loaded backlash value, m or rad; none: no backlash value
                                     ///< was loaded
};

/// Writes the folder <folder of the campaign>-check next to the original. It contains the new
/// readings, the loaded table, and the original manifest reduced to this measurement, with purpose
/// "check" and the day. Returns the folder. An error if the folder exists, or if the manifest
/// cannot be converted by changing single lines.
Expected<std::filesystem::path> write_check_campaign(const OpenCampaign& open,
                                                     const CheckCampaign& check);

}  // namespace nonio::app
