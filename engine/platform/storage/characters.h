// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nonio::storage {

/// One UTF-8 character (RFC 3629: shortest form, no surrogates); size 0 if the bytes are invalid.
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

/// Decodes the first character of a text that is not empty. Its size is 0 if it is not valid UTF-8.
Character first_of(std::string_view text);
/// Whether the character is visible and harmless: not a control character, not invisible, not of a
/// private-use area, no change of the direction of writing.
bool is_shown(std::uint32_t code);

}  // namespace nonio::storage
