// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/tables/control_state.h"
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

/// What was active during the measurement, by axis, as a person stated it on the terminal.
using StateAnswers = std::map<std::string, tables::StateAnswer>;

/// On a terminal, prints `why` and asks for the state of each of these axes that nothing states;
/// otherwise empty. An error if an answer is missing.
Expected<StateAnswers> ask_for_states(OpenCampaign& open, const Controller& control,
                                      const std::vector<std::string>& axes, const Error& why,
                                      const Common& common);

/// Enters the answers into the record of the machine, if the campaign names the machine and states
/// its day. Returns the name of the record; empty: not entered.
Expected<std::string> record_answers(const OpenCampaign& open, const StateAnswers& answers);

/// Returns a finding if a later campaign measured the axis again; otherwise the list is empty.
std::vector<Finding> older_measurement(const OpenCampaign& open, const std::string& axis);

}  // namespace nonio::app
