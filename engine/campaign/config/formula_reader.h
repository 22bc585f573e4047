// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/toml_reader.h"
#include "nonio/sdk/campaign.h"

namespace nonio::config {

/// [[formula]] of [model], or of a simulation: read and tried, so that what is wrong with them is
/// stated with the rest.
std::vector<Formula> read_formulas(TableReader& table, const Machine& machine);

Formula::Parameter read_parameter(TableReader& reader);

}  // namespace nonio::config
