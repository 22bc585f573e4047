// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/plugin.h"

namespace nonio::spreadsheet {

/// Whether the first bytes are those of a ZIP archive.
bool recognises(std::string_view head);

/// The table of a sheet, read as the reader csv reads it: the first row with known column names begins
/// it, a blank row ends it. Lines of errors and readings are rows of the sheet. Options: `sheet`, the
/// name of a sheet (default: the only one with such a row). Errors as of csv; a workbook that is damaged
/// or encrypted; two sheets with readings.
/// The first rows of the longest sheet, from the one with most cells on.
Expected<std::vector<std::vector<std::string>>> first_rows(std::string_view bytes,
                                                           std::size_t most);
Expected<Observations> read(const ReadInput& input);

}  // namespace nonio::spreadsheet
