// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_verb.h"

namespace nonio::app {

/// A state of the control that a command was given.
struct NewState {
  std::string since, source;         ///< as in [[axes.X.state]]
  std::vector<Artifact> files;       ///< none: there is no table
  std::optional<double> backlash{};  ///< m or rad
  std::vector<LoadedTable> tables{};
  std::optional<double> reference{};  ///< where the table is zero, in mm or deg
};

/// Adds the states of an axis to machines/<asset>.toml of the campaign's site, and copies their
/// files next to it; states that the record has stay as they are. Gives the name of the record. An
/// error if the campaign does not name its machine, or if the record could not be read afterwards:
/// then it is unchanged.
Expected<std::string> add_states(const OpenCampaign& open, const std::string& axis,
                                 const std::vector<NewState>& states);

}  // namespace nonio::app
