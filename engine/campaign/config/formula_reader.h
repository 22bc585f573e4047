// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/toml_reader.h"
#include "nonio/sdk/campaign.h"

namespace nonio::config {

/// [[formula]] of [model], or of a simulation: read and tried, so that what is wrong with them is
/// stated with the rest.
/// The last formula, after its keys were read.
void check_formula(TableReader& reader, std::vector<Formula>& all, const Machine& machine);

}  // namespace nonio::config
