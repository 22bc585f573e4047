// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// Returns an error unless the library is a plugin for this program. The library is never unloaded.
Expected<const PluginEntry*> open_entry(const std::filesystem::path& path);

}  // namespace nonio::loader
