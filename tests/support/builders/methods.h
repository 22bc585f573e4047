// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "campaign/loader/plugins.h"

namespace nonio {

/// The methods of the program's own plugins, from the folder in which they are built.
inline const std::vector<Method>& own_methods() {
  static const auto* plugins = [] {
    auto* loaded = new loader::Plugins;
    loaded->load_file(std::filesystem::path(NONIO_TEST_PLUGINS) / "methods.so", "");
    return loaded;
  }();
  return plugins->methods();
}

}  // namespace nonio
