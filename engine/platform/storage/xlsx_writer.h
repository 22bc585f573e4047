// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "platform/storage/workbook.h"

namespace nonio::storage {

struct XlsxWriter {
  Expected<void> (*write)(const Workbook& book, const std::filesystem::path& file,
                          const std::filesystem::path& temporary_folder) = nullptr;
};

}  // namespace nonio::storage
