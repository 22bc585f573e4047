// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

namespace nonio::config {

/// "a.ini,b.ini": the files of one table.
Expected<std::vector<Artifact>> read_table_files(const std::string& list);
/// The same from inside of a folder, each of at most 1 MB.
Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base);

}  // namespace nonio::config
