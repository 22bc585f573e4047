// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/config/manifest.h"

namespace nonio::host::config {

/// The files in which key and password lie, wherever they are.
std::vector<std::filesystem::path> secret_files(const Signing& signing,
                                                const std::filesystem::path& site);

}  // namespace nonio::host::config
