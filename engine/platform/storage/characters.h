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

/// Decodes the first character; `text` must not be empty.
Character first_of(std::string_view text);
/// False for control characters, invisible characters, private-use characters and changes of the
/// writing direction.
bool is_shown(std::uint32_t code);

}  // namespace nonio::storage
