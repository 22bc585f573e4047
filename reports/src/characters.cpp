// SPDX-License-Identifier: Apache-2.0
#include "characters.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace nonio::reports {
namespace {

struct Composition {
  std::uint16_t first, second, composed;
};
constexpr Composition compositions[] = {
#include "compositions.inc"
};

/// The one character for both, or 0; `second` 0: the character that stands for the first.
char32_t composed(char32_t first, char32_t second) {
  const auto less = [](const Composition& c, const std::pair<char32_t, char32_t>& both) {
    return std::tuple<char32_t, char32_t>(c.first, c.second) < std::tie(both.first, both.second);
  };
  const auto* it = std::lower_bound(std::begin(compositions), std::end(compositions),
                                    std::pair(first, second), less);
  return it != std::end(compositions) && it->first == first && it->second == second ? it->composed
                                                                                    : 0;
}

}  // namespace

char32_t next_character(std::string_view text, std::size_t& i) {
  const auto byte = [&](std::size_t at) {
    return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
  };
  const unsigned lead = byte(i);
  const std::size_t size = lead < 0x80                    ? 1
                           : lead >= 0xC2 && lead <= 0xDF ? 2
                           : lead >= 0xE0 && lead <= 0xEF ? 3
                           : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                          : 0;
  char32_t c = size == 1 ? lead : lead & (0x7FU >> size);
  bool right = size != 0;
  for (std::size_t k = 1; k < size; ++k) {
    right = right && (byte(i + k) & 0xC0) == 0x80;
    c = c << 6 | (byte(i + k) & 0x3F);
  }
  constexpr std::array<char32_t, 5> least = {0, 0, 0x80, 0x800, 0x10000};
  if (!right || c < least[size] || (c >= 0xD800 && c < 0xE000) || c > 0x10FFFF) {
    ++i;
    return not_utf8;
  }
  i += size;
  return c;
}

char32_t next_composed(std::string_view text, std::size_t& i) {
  char32_t c = next_character(text, i);
  if (c >= 0x80 && c < 0x2200)
    if (const char32_t other = composed(c, 0); other != 0) c = other;
  while (i < text.size() && static_cast<unsigned char>(text[i]) >= 0x80) {
    std::size_t behind = i;
    char32_t mark = next_character(text, behind);
    if (mark < 0x0300 || mark > 0x036F) break;
    if (const char32_t other = composed(mark, 0); other != 0) mark = other;
    const char32_t both = composed(c, mark);
    if (both == 0) break;
    c = both;
    i = behind;
  }
  return c;
}

bool is_control(char32_t c) { return c < 0x20 || (c >= 0x7F && c < 0xA0); }

bool bears_accent(char32_t c) {
  return (c >= U'A' && c <= U'Z') || (c >= U'a' && c <= U'z') ||
         (c >= 0xC0 && c < 0x250 && c != 0xD7 && c != 0xF7) || (c >= 0x386 && c < 0x530);
}

bool begins_no_line(char32_t c) {
  constexpr std::u32string_view signs =
      U"!%),-./:;?]}\u00A0\u00B0\u00B7\u00BB\u2013\u2014\u2019\u201D\u2026\u2030\u2032\u2033"
      U"、。々〉》」』】〕〗〞〟゛゜ゝゞ・ーヽヾぁぃぅぇぉっゃゅょゎァィゥェォッャュョヮヵヶ"
      U"！％），．：；？］｝～｠｡｣､･";
  return signs.find(c) != std::u32string_view::npos;
}

bool ends_no_line(char32_t c) {
  constexpr std::u32string_view signs =
      U"([{\u00A0\u00A3\u00AB\u2018\u201C\u20AC\u2116〈《「『【〔〖〝（［｛｟｢￥＄￡";
  return signs.find(c) != std::u32string_view::npos;
}

}  // namespace nonio::reports
