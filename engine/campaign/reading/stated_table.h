// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/loader/plugins.h"

namespace nonio::reading {

/// A table in a file whose columns a person can describe.
struct StatedTable {
  const Reader* reader = nullptr;  ///< reader that can read the table with its option `columns`
  std::vector<std::vector<std::string>> rows;
};

/// Name of the option of a reader that describes the columns.
inline constexpr const char* columns_option = "columns";

/// Returns the first rows, at most `most`, of the table in a file; none if no reader finds a table
/// with at least two columns.
std::optional<StatedTable> stated_table(const loader::Plugins& plugins, std::string_view bytes,
                                        std::size_t most);

}  // namespace nonio::reading
