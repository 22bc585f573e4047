// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::loader {

/// Returns the symbols that an ELF library exports, without weak copies of templates of the
/// standard library, which every compiler adds.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library);

}  // namespace nonio::loader
