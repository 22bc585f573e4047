// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

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
