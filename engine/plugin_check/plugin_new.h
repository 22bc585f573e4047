// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::plugin_check {

/// Writes the skeleton of a plugin into a folder that does not exist yet. Skeletons are folders of
/// files named *.in, in whose names and texts @name@ stands for the plugin's name and @file@ for
/// the same as a C++ name. Gives the files that it wrote.
Expected<std::vector<std::string>> new_plugin(const std::filesystem::path& skeletons,
                                              const std::string& kind, const std::string& name,
                                              const std::filesystem::path& folder);

}  // namespace nonio::plugin_check
