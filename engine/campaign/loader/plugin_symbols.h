// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::loader {

/// What an ELF library exports, without what every compiler leaves in it: weak copies of the
/// standard library's templates.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library);

}  // namespace nonio::loader
