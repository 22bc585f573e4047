// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// The entry of a library that may be called, or why not. The library is never unloaded.
Expected<const PluginEntry*> open_entry(const std::filesystem::path& path);

}  // namespace nonio::loader
