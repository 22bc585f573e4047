// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/results.h"

namespace nonio::simulation {

struct Simulated {
  std::vector<Artifact> campaign;  ///< files of readings, then campaign.toml
  std::string truth;  ///< JSON: the simulated errors; to be stored outside of the campaign
};

/// First line of a simulated campaign.toml. A folder whose manifest begins with another line is not
/// overwritten.
inline constexpr std::string_view simulated_mark =
    "# Simulated by nonio: nobody measured this machine.";

/// Simulates a campaign with known effects from a specification (docs/simulate.md): a manifest with
/// [simulation], a [[cycle]] for each measurement and an [[effect]] for each cause. The same text
/// gives the same bytes. `file` is the name of the specification in error messages.
config::Checked<Simulated> simulate(std::string_view specification, const std::string& file,
                                    const std::vector<Effect>& effects,
                                    const std::vector<Method>& methods);

}  // namespace nonio::simulation
