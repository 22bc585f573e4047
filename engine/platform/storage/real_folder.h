// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace nonio::storage {

/// As `fs::canonical`, of a folder. Neighbouring folders take only a few calls: the result for
/// their parent is used again while both its path and that result lead to the same folder as
/// before.
std::filesystem::path real_folder(const std::filesystem::path& folder, std::error_code& error);

}  // namespace nonio::storage
