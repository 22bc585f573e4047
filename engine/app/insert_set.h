// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/tables/control_state.h"
#include "campaign/tables/cross_merge.h"
#include "campaign_verb.h"
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

struct LaterCampaign {
  std::filesystem::path folder;
  std::string id, date, purpose;
};

/// Returns the campaigns with readings of the same machine and axis and a later date, or the same
/// date and purpose "check", sorted by date. Searches the site or, without a site, the folders with
/// the same parent. Unreadable manifests are skipped. Empty if this campaign has no date.
std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis);

/// A state of the control, to be entered into the record of a machine.
struct NewState {
  std::string since, source;         ///< keys of [[axes.X.state]]: date and source
  std::vector<Artifact> files;       ///< files of the table; empty if no table was active
  std::optional<double> backlash{};  ///< m or rad; std::nullopt is not entered
  std::vector<LoadedTable> tables{};
  /// Position at which the table is zero, mm or deg; std::nullopt is not entered.
  std::optional<double> reference{};
};

/// Adds the states of an axis to machines/<asset>.toml of the site and copies their files next to
/// it. Existing states are unchanged. Returns the name of the record. An error, with the record
/// unchanged, if the campaign states no asset or if the new record would be invalid.
Expected<std::string> add_states(const OpenCampaign& open, const std::string& axis,
                                 const std::vector<NewState>& states);

}  // namespace nonio::app
