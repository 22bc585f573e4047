// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/tables/control_state.h"
#include "campaign/tables/cross_merge.h"
#include "table_common.h"

/// `table insert` and `table session` for several axes together.
namespace nonio::app {

/// Replaces the table of the axis in the backup (`tables::merge_tables`), unless its readings are
/// implausible.
Expected<tables::MergedTables> merge_axis_now(const OpenCampaign& open, const Loaded& present,
                                              const Settings& options, const std::string& axis);

/// Evaluates the campaign and replaces the tables of the axes in the backup (`tables::merge_set`).
Expected<tables::MergedSet> merge_set_now(const OpenCampaign& open, const Loaded& present,
                                          const Settings& options,
                                          const std::vector<std::string>& set);

/// Enters the states of all axes of the set into the record of the machine (`record_loading`).
Expected<std::string> record_set(const tables::MergedSet& merged, const Loaded& present,
                                 const Settings& options, const std::vector<std::string>& set,
                                 const std::string& loaded, const OpenCampaign& open);

struct SetWish {
  std::string axis, out, loaded;
};
/// Inserts the tables of several axes into a backup; returns the exit status.
int insert_set(const SetWish& wish, const Loaded& present, const Settings& options,
               const std::vector<std::string>& set, OpenCampaign& open, const Common& common);

}  // namespace nonio::app
