// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/toml_reader.h"
#include "nonio/sdk/campaign.h"

namespace nonio::config {

/// Must be called after the keys of the last formula were read.
void check_formula(TableReader& reader, std::vector<Formula>& all, const Machine& machine);

}  // namespace nonio::config
