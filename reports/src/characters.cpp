// SPDX-License-Identifier: Apache-2.0
#include "characters.h"

#include <utf8proc.h>

#include <array>

namespace nonio::reports {
namespace {

/// The NFC composition of both characters (or of `first` if `second` is 0); 0 if there is none.
char32_t composed(char32_t first, char32_t second) {
  std::array<utf8proc_int32_t, 32> parts{};
  utf8proc_ssize_t size = 0;
  for (const char32_t c : {first, second}) {
    if (c == 0) continue;
    const auto left = static_cast<utf8proc_ssize_t>(parts.size()) - size;
    int boundary = 0;
    const utf8proc_ssize_t more = utf8proc_decompose_char(
        static_cast<utf8proc_int32_t>(c), parts.data() + size, left, UTF8PROC_DECOMPOSE, &boundary);
    if (more < 0 || more > left) return 0;
    size += more;
  }
  const auto made = utf8proc_normalize_utf32(
      parts.data(), size, static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE));
  return made == 1 ? static_cast<char32_t>(parts[0]) : 0;
}

}  // namespace

char32_t next_character(std::string_view text, std::size_t& i) {
  utf8proc_int32_t c = -1;
  const auto size = utf8proc_iterate(reinterpret_cast<const utf8proc_uint8_t*>(text.data()) + i,
                                     static_cast<utf8proc_ssize_t>(text.size() - i), &c);
  if (size <= 0) {
    ++i;
    return not_utf8;
  }
  i += static_cast<std::size_t>(size);
  return static_cast<char32_t>(c);
}

char32_t next_composed(std::string_view text, std::size_t& i) {
  const auto is_ascii = [&](std::size_t at) { return static_cast<unsigned char>(text[at]) < 0x80; };
  if (is_ascii(i) && (i + 1 == text.size() || is_ascii(i + 1)))  // fast path: no mark follows
    return static_cast<unsigned char>(text[i++]);
  char32_t c = next_character(text, i);
  if (c == not_utf8) return c;
  if (c >= 0x80)
    if (const char32_t other = composed(c, 0); other != 0) c = other;
  while (i < text.size() && static_cast<unsigned char>(text[i]) >= 0x80) {
    std::size_t behind = i;
    const char32_t mark = next_character(text, behind);
    if (mark < 0x0300 || mark > 0x036F) break;
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
