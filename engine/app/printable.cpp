// SPDX-License-Identifier: Apache-2.0
#include "printable.h"

#include <array>
#include <cstdint>
#include <cstdio>

#include "platform/storage/characters.h"

namespace nonio::app {
using storage::Character;

namespace {

std::string escaped(const char* format, std::uint32_t code) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), format, code);
  return text.data();
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = storage::first_of(text);
    const std::size_t size = c.size == 0 ? 1 : c.size;
    if (c.size == 0)
      out += escaped("\\x%02x", static_cast<unsigned char>(text.front()));
    else if (storage::is_shown(c.code))
      out += text.substr(0, size);
    else
      out += escaped(c.code < 0x100 ? "\\x%02x" : "\\u%04x", c.code);
    text.remove_prefix(size);
  }
  return out;
}

}  // namespace nonio::app
