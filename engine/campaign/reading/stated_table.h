// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/loader/plugins.h"

namespace nonio::reading {

/// A table in a file, of which a person may state what the columns are.
struct StatedTable {
  const Reader* reader = nullptr;  ///< that reads it with option `columns`
  std::vector<std::vector<std::string>> rows;
};

/// The name of that option, and an entry of it.
inline constexpr const char* columns_option = "columns";

/// The first rows of the table in a file; none if no reader finds one with two columns.
std::optional<StatedTable> stated_table(const loader::Plugins& plugins, std::string_view bytes,
                                        std::size_t most);

}  // namespace nonio::reading
