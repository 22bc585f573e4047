// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "table_common.h"

/// What `table insert` and `table session` share.
namespace nonio::app {

/// The axis that is given, or the only one that was measured.
Expected<std::string> merged_axis(const std::string& axis, const Campaign& campaign);

/// That the day of loading is not before that of the measurement.
Expected<void> check_day(const std::string& loaded, const std::string& day);

/// What the control had while the axis was measured, where only the backup states it, and what is
/// loaded from this day on. Gives the name of the record; nothing without a day.
Expected<std::string> record_loading(const tables::MergedTables& merged, const Loaded& present,
                                     const Settings& options, const std::string& axis,
                                     const std::string& loaded, const OpenCampaign& open);

/// That the axis was measured again after this campaign; none: it was not.
std::vector<Finding> older_measurement(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
