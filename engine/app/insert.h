// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "table_common.h"

namespace nonio::app {

/// Returns `axis`, or the only measured axis if `axis` is empty. An error if this is ambiguous.
Expected<std::string> merged_axis(const std::string& axis, const Campaign& campaign);

/// Returns an error if the date of loading precedes that of the measurement or if the measurement
/// has no date. An empty date of loading is accepted.
Expected<void> check_day(const std::string& loaded, const std::string& day);

/// Enters the table loaded on this date into the record of the machine, after the state of the
/// control during the measurement if only the backup contains it. Returns the file name of the
/// record, or an empty string if `loaded` is empty.
Expected<std::string> record_loading(const tables::MergedTables& merged, const Loaded& present,
                                     const Settings& options, const std::string& axis,
                                     const std::string& loaded, const OpenCampaign& open);

/// Returns a finding if a later campaign measured the axis again; otherwise the list is empty.
std::vector<Finding> older_measurement(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
