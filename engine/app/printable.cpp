// SPDX-License-Identifier: Apache-2.0
#include "printable.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace nonio::app {

namespace {

/// One character of UTF-8 (RFC 3629: shortest form, no surrogates); size 0 if it is none.
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

Character first_of(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 0;
  if (size == 0 || lead > 0xF4 || text.size() < size) return {};
  std::uint32_t code = lead & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0U) != 0x80) return {};
    code = code << 6 | (next & 0x3FU);
  }
  const bool too_long = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000);
  if (too_long || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF) return {};
  return {code, size};
}

bool is_shown(std::uint32_t c) {
  const auto in = [c](std::uint32_t from, std::uint32_t to) { return c >= from && c <= to; };
  return !(c < 0x20 || in(0x7F, 0x9F) || c == 0xAD || c == 0x61C || c == 0x180E ||
           in(0x200B, 0x200F) || in(0x2028, 0x202E) || in(0x2060, 0x206F) || in(0xFE00, 0xFE0F) ||
           c == 0xFEFF || in(0xFFF9, 0xFFFB) || in(0xE000, 0xF8FF) || c >= 0xE0000);
}

std::string escaped(const char* format, std::uint32_t code) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), format, code);
  return text.data();
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = first_of(text);
    const std::size_t size = c.size == 0 ? 1 : c.size;
    if (c.size == 0)
      out += escaped("\\x%02x", static_cast<unsigned char>(text.front()));
    else if (is_shown(c.code))
      out += text.substr(0, size);
    else
      out += escaped(c.code < 0x100 ? "\\x%02x" : "\\u%04x", c.code);
    text.remove_prefix(size);
  }
  return out;
}

}  // namespace nonio::app
