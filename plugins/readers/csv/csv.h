// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "nonio/sdk/plugin.h"

namespace nonio::csv {

/// Whether the first bytes of a file look like a CSV file with at least one column known here.
bool recognises(std::string_view head);

/// The kinds of measurement that this reader reads.
bool reads(std::string_view measurement_kind);

/// What a person states of columns with other names, for readings of one axis or diagonal.
inline constexpr std::string_view columns_option = "columns";
Option columns_declared();

/// The first rows as text, the names of the columns first.
Expected<std::vector<std::vector<std::string>>> first_rows(std::string_view bytes,
                                                           std::size_t most);

/// A whole file, or an error with its line and column. Never a part of a file.
Expected<Observations> read(const ReadInput& input);

}  // namespace nonio::csv
