// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

struct FileWish {
  std::vector<std::string> columns{};  ///< entries of option `columns`
  std::string axis{};                  ///< axis that the readings probably belong to; empty:
                                       ///< unknown
};

/// Does `nonio check FILE`: reports which reader reads a file of readings of one axis, and the
/// readings; if none does, why, and the first rows of its table. Prints `nonio-check-file/1` with
/// --json. Returns status 1 if the file cannot be read.
int check_file(const std::filesystem::path& file, const FileWish& wish, const Common& common);

}  // namespace nonio::app
