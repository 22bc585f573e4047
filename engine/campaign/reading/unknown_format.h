// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace nonio::reading {

/// Line of the first content of a text, from 1; 1 if it has none.
std::uint64_t first_content_line(std::string_view bytes);

/// What is wrong with a file of readings that no reader knows: a format that is known by its name,
/// or what its first line has and what was expected there.
std::string what_is_wrong(std::string_view bytes, std::string_view file);

}  // namespace nonio::reading
