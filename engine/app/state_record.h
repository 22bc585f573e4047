// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// A state of the control to be entered into the record of a machine.
struct NewState {
  std::string since, source;         ///< day and source of the state, as in [[axes.X.state]] of the
                                     ///< record
  std::vector<Artifact> files;       ///< files of the table; empty: there is no table
  std::optional<double> backlash{};  ///< backlash value, m or rad; none: not entered
  std::vector<LoadedTable> tables{};
  std::optional<double> reference{};  ///< position at which the table is zero, mm or deg; none: not
                                      ///< entered
};

/// Adds the states of an axis to machines/<asset>.toml of the campaign's site, and copies their
/// files next to it; existing states are unchanged. Returns the name of the record. An error if the
/// campaign does not name its machine, or if the changed record would be invalid; then it is left
/// unchanged.
Expected<std::string> add_states(const OpenCampaign& open, const std::string& axis,
                                 const std::vector<NewState>& states);

}  // namespace nonio::app
