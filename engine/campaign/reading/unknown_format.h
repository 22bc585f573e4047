// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace nonio::reading {

/// Returns the line number of the first content of a text, from 1; 1 if it has none.
std::uint64_t first_content_line(std::string_view bytes);

/// Returns what is wrong with a file that no reader recognizes: its format according to the file's
/// name, its line ends, or its first line and what was expected in this line.
std::string what_is_wrong(std::string_view bytes, std::string_view file);

}  // namespace nonio::reading
