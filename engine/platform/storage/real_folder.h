// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace nonio::storage {

/// As `fs::canonical`, of a folder. Those beside each other take a few calls: what was found of their
/// parent the last time is taken again while both its path and what was found lead to the same folder
/// as then.
std::filesystem::path real_folder(const std::filesystem::path& folder, std::error_code& error);

}  // namespace nonio::storage
