// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

struct FileWish {
  std::vector<std::string> columns{};  ///< entries of option `columns`
  std::string axis{};                  ///< that its readings probably are of; empty: unknown
};

/// `nonio check FILE`: which reader reads a file of readings of one axis, and the readings; where
/// none does, why, and the first rows of its table. Prints `nonio-check-file/1` with --json. Status
/// 1 if it cannot be read.
int check_file(const std::filesystem::path& file, const FileWish& wish, const Common& common);

}  // namespace nonio::app
