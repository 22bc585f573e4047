// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

namespace nonio::config {

/// `list`: paths separated by commas, for example "a.ini,b.ini".
Expected<std::vector<Artifact>> read_table_files(const std::string& list);
/// `list`: paths inside `base`, separated by commas. Each file has at most 1 MB.
Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base);

}  // namespace nonio::config
