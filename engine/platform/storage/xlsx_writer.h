// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "platform/storage/workbook.h"

namespace nonio::storage {

/// The function that the library nonio_xlsx exports; `xlsx_bytes` calls it.
struct XlsxWriter {
  Expected<void> (*write)(const Workbook& book, const std::filesystem::path& file,
                          const std::filesystem::path& temporary_folder) = nullptr;
};

}  // namespace nonio::storage
