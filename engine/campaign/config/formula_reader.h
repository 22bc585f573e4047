// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/toml_reader.h"
#include "nonio/sdk/campaign.h"

namespace nonio::config {

/// Checks and tries the last formula of [model] or of a simulation after its keys were read, so
/// that its errors are reported together with all others.
void check_formula(TableReader& reader, std::vector<Formula>& all, const Machine& machine);

}  // namespace nonio::config
