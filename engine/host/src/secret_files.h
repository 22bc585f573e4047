// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/host/manifest.h"

namespace nonio::host {

/// The files in which key and password lie, wherever they are.
std::vector<std::filesystem::path> secret_files(const Signing& signing,
                                                const std::filesystem::path& site);

}  // namespace nonio::host
