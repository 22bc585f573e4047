// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::loader {

/// Omits weak symbols, because compilers add copies of templates of the standard library.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library);

}  // namespace nonio::loader
