// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nonio::storage {

/// One character of UTF-8 (RFC 3629: shortest form, no surrogates); size 0 if it is none.
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

/// Of a text that is not empty.
Character first_of(std::string_view text);
/// Whether a reader sees it: no control character, no invisible one, none that turns the direction
/// of writing.
bool is_shown(std::uint32_t code);

}  // namespace nonio::storage
