// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/plugin.h"

namespace nonio::spreadsheet {

/// Whether the first bytes are those of a ZIP archive.
bool recognises(std::string_view head);

/// The first rows of the longest sheet, starting at its fullest row.
Expected<std::vector<std::vector<std::string>>> first_rows(std::string_view bytes,
                                                           std::size_t most);
/// Reads the table of a sheet like the reader csv, from the first row with known column names to
/// the next blank row. Error lines are rows of the sheet. Option `sheet`: its name (default: the
/// only one with such a row). Errors: those of csv, a damaged or encrypted workbook, two sheets
/// with readings.
Expected<Observations> read(const ReadInput& input);

}  // namespace nonio::spreadsheet
