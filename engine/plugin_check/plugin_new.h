// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::plugin_check {

/// Writes the skeleton of a plugin into a folder that does not exist yet, and returns the names of
/// its files. Skeletons are folders of files named *.in, in which @name@ is replaced by the
/// plugin's name and @file@ by a C++ name.
Expected<std::vector<std::string>> new_plugin(const std::filesystem::path& skeletons,
                                              const std::string& kind, const std::string& name,
                                              const std::filesystem::path& folder);

}  // namespace nonio::plugin_check
