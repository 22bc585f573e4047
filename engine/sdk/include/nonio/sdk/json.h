// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"

namespace nonio {

/// Returns a quoted JSON string (RFC 8259). A byte that is not UTF-8 becomes U+FFFD.
inline std::string json_text(std::string_view text) {
  constexpr std::string_view hex = "0123456789abcdef", plain = "\"\\\b\f\n\r\t",
                             escaped = "\"\\bfnrt";
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (const std::size_t k = plain.find(text[i]); k != plain.npos) {
      out += {'\\', escaped[k]};
    } else if (byte < 0x20) {
      out += {'\\', 'u', '0', '0', hex[byte >> 4U], hex[byte & 15U]};
    } else if (byte < 0x80) {
      out += text[i];
    } else {
      const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : 2;
      const std::string_view character = text.substr(i, length);
      if (character.size() == length && is_utf8(character)) {
        out += character;
        i += length - 1;
      } else {
        append_utf8(out, 0xFFFD);
      }
    }
  }
  return out + '"';
}

/// Returns the shortest number that parses to the same double; null if it is not finite.
inline std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  std::string out;
  append_shortest(out, value);
  return out;
}

}  // namespace nonio
