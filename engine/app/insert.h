// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "table_common.h"

/// Functions shared by `table insert` and `table session`.
namespace nonio::app {

/// Returns `axis`, or if it is empty the only axis that was measured; an error if none or several
/// were measured.
Expected<std::string> merged_axis(const std::string& axis, const Campaign& campaign);

/// Returns an error if the day of loading is before that of the measurement, or if the day of the
/// measurement is unknown. Without a day of loading there is no error.
Expected<void> check_day(const std::string& loaded, const std::string& day);

/// Enters into the record of the machine the state of the control during the measurement, if only
/// the backup states it, and the table loaded on this day. Returns the name of the record; empty
/// without a day.
Expected<std::string> record_loading(const tables::MergedTables& merged, const Loaded& present,
                                     const Settings& options, const std::string& axis,
                                     const std::string& loaded, const OpenCampaign& open);

/// Returns a finding if the axis was measured again after this campaign; otherwise none.
std::vector<Finding> older_measurement(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
