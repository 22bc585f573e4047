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

/// Does `nonio check FILE`: reports the reader of a file of readings of one axis, and the readings.
/// If no reader reads the file, reports the reason and the first rows of its table. Prints
/// `nonio-check-file/1` with --json. Returns status 1 if the file cannot be read.
int check_file(const std::filesystem::path& file, const FileWish& wish, const Common& common);

}  // namespace nonio::app
