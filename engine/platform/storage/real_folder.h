// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace nonio::storage {

/// Resolves all links in the path of a folder, like `fs::canonical`. The result for the parent
/// folder is reused for its other subfolders, while both paths still lead to the same folder.
std::filesystem::path real_folder(const std::filesystem::path& folder, std::error_code& error);

}  // namespace nonio::storage
