// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace nonio::reading {

/// Counted from 1; 1 if the text has no content.
std::uint64_t first_content_line(std::string_view bytes);

/// Describes a file that no reader recognizes by its format, line ends or first line.
std::string what_is_wrong(std::string_view bytes, std::string_view file);

}  // namespace nonio::reading
