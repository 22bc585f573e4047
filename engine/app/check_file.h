// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

/// `nonio check FILE`: which reader reads a file of readings of one axis, and the readings; where
/// none does, why, and the first rows of its table. `columns`: entries of option `columns`.
/// Prints `nonio-check-file/1` with --json. Status 1 if it cannot be read.
int check_file(const std::filesystem::path& file, const std::vector<std::string>& columns,
               const Common& common);

}  // namespace nonio::app
