// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

struct FileWish {
  std::vector<std::string> columns{};  ///< entries of the reader option `columns`
  std::string axis{};                  ///< probable axis of the readings; empty if unknown
};

/// Implements `nonio check FILE`: prints the reader that accepts the file and the number of
/// readings, or the reason why no reader accepts it. Returns exit status 1 if the file cannot be
/// read.
int check_file(const std::filesystem::path& file, const FileWish& wish, const Common& common);

}  // namespace nonio::app
