// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cctype>
#include <string_view>

namespace nonio {

/// Whether `text` (UTF-8) contains an ASCII letter or digit, or a character outside of ASCII that
/// is not punctuation. False for "", "  ", "-", "—" and "?".
inline bool has_content(std::string_view text) {
  // Latin-1 A0 to BF, general punctuation, minus, CJK punctuation, full-width hyphen.
  const auto is_mark = [](std::string_view c) {
    return c[0] == '\xC2' || c.starts_with("\xE2\x80") || c.starts_with("\xE2\x81") ||
           c == "\xE2\x88\x92" || c.starts_with("\xE3\x80") || c.starts_with("\xEF\xBC\x8D");
  };
  for (std::size_t at = 0; at < text.size();) {
    const auto c = static_cast<unsigned char>(text[at]);
    const std::size_t length = c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
    if (length == 1 ? std::isalnum(c) != 0 : !is_mark(text.substr(at, length))) return true;
    at += length;
  }
  return false;
}

}  // namespace nonio
