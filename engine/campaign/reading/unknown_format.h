// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/loader/plugins.h"

namespace nonio::reading {

/// Counted from 1; 1 if the text has no content.
std::uint64_t first_content_line(std::string_view bytes);

/// Describes a file that no reader recognizes by its format, line ends or first line.
std::string what_is_wrong(std::string_view bytes, std::string_view file);

struct StatedTable {
  const Reader* reader = nullptr;  ///< reader of the table with option `columns`
  std::vector<std::vector<std::string>> rows;
};

inline constexpr const char* columns_option = "columns";

/// Returns at most `most` rows; nullopt if no reader finds two columns or more.
std::optional<StatedTable> stated_table(const loader::Plugins& plugins, std::string_view bytes,
                                        std::size_t most);

}  // namespace nonio::reading
