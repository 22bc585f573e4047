// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/host/evaluate.h"

namespace nonio::host {

/// site.toml of a site, if there is one; every error with its line.
Checked<SiteFile> read_site(const std::filesystem::path& site, std::string& digest);

/// All template folders laid over each other, the later ones winning, and one digest of them.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   std::string& digest);

}  // namespace nonio::host
