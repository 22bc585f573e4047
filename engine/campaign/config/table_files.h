// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

namespace nonio::config {

/// Reads the files of one table from a list such as "a.ini,b.ini".
Expected<std::vector<Artifact>> read_table_files(const std::string& list);
/// Reads the files of one table from a list of paths inside the folder `base`, each file at most 1
/// MB.
Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base);

}  // namespace nonio::config
