// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace nonio::storage {

/// Resolves links like `fs::canonical`, but reuses the result of the parent folder for its other
/// subfolders while both paths still lead to the same folder.
std::filesystem::path real_folder(const std::filesystem::path& folder, std::error_code& error);

}  // namespace nonio::storage
