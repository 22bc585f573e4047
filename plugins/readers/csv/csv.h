// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/plugin.h"

namespace nonio::csv {

/// Whether the start of a file is CSV with at least one known column.
bool recognises(std::string_view head);

bool reads(std::string_view measurement_kind);

/// Option that maps columns with other names, for readings of one axis or diagonal.
inline constexpr std::string_view columns_option = "columns";
Option columns_declared();

Expected<std::vector<std::vector<std::string>>> first_rows(std::string_view bytes,
                                                           std::size_t most);

/// Error: an invalid line or column; no partial result.
Expected<Observations> read(const ReadInput& input);

}  // namespace nonio::csv
