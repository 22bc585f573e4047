// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::host {

/// SHA-256 in lower-case hexadecimal.
std::string sha256(std::string_view bytes);
Expected<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace nonio::host
