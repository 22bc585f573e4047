// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// Loads a library and returns its entry; an error if it is not a plugin for this program. The
/// library is never unloaded.
Expected<const PluginEntry*> open_entry(const std::filesystem::path& path);

}  // namespace nonio::loader
