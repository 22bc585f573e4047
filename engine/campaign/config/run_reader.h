// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/toml_reader.h"

/// Tables that campaign.toml and site.toml both have: [run] and [options].
namespace nonio::config {

RunChoice read_run(TableReader& top);

/// Of plugins that only the run knows: their errors are reported there.
RawOptions read_options(TableReader& top, std::vector<Error>& errors);

}  // namespace nonio::config
