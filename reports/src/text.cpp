// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <utf8proc.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "font_reader.h"
#include "nonio/reports/text.h"

namespace nonio::reports {

namespace {

std::string hex(std::uint32_t value, int digits) {
  std::array<char, 16> buffer{};
  auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, 16).ptr;
  std::string text(buffer.data(), end);
  for (char& c : text)
    if (c >= 'a') c = static_cast<char>(c - 'a' + 'A');
  while (text.size() < static_cast<std::size_t>(digits)) text.insert(0, 1, '0');
  return text;
}

Error unprintable(std::string_view part, char32_t c, std::string_view field) {
  std::string what;
  if (c == not_utf8)
    what = "the byte 0x" + hex(static_cast<unsigned char>(part[0]), 2) + ", which is not UTF-8";
  else if (is_control(c))
    what = "the control character U+" + hex(c, 4);
  else
    what = "the character \"" + std::string(part) + "\" (U+" + hex(c, 4) +
           "), which the report's fonts do not have";
  return Error{std::string(field) + ": printable text was expected, found " + what};
}

struct Box {
  int left, right, low, high;  ///< 1/1000 of the font size
};

Box box_of(const Font& font, std::uint16_t glyph) {
  const FontReader r(font.bytes);
  const std::size_t head = *r.table("head");
  const std::size_t at = Outlines(r, head, *r.table("loca"), *r.table("glyf")).begin(glyph);
  const auto side = [&](std::size_t k) { return r.s16(at + k) * 1000 / font.units; };
  return {side(2), side(6), side(4), side(8)};
}

/// Places an accent centered above the preceding letter, without advance.
Glyph accent_over(const Font& font, std::uint16_t letter, std::uint16_t accent) {
  constexpr int gap = 50;  // as in the accented letters of the fonts
  const Box below = box_of(font, letter), above = box_of(font, accent);
  Glyph out{accent, 0, false, false};
  out.shift = static_cast<std::int16_t>((below.left + below.right - above.left - above.right) / 2 -
                                        font.advance[letter]);
  out.rise = static_cast<std::int16_t>(below.high + gap - above.low);
  return out;
}

/// A glyph of another font, with estimated width; invalid bytes are shown as U+FFFD.
Glyph foreign_glyph(char32_t c) {
  constexpr char32_t first_ideograph = 0x2E80;
  Glyph out{0, static_cast<std::uint16_t>(c >= first_ideograph ? 1000 : 600), false, false};
  out.character = c == not_utf8 || is_control(c) ? U'\uFFFD' : c;
  return out;
}

Glyph glyph_of(char32_t c, const Font& font, const Font& wide) {
  if (c == not_utf8 || is_control(c)) return {0, 0, false, false};
  if (const std::uint16_t id = font.glyph(c); id != 0) {
    const bool space = c == U' ';
    return {id, font.advance[id], space, space || c == U'-' || c == U'\u2013'};
  }
  const std::uint16_t id = wide.glyph(c);
  const bool space = c == U'\u3000';
  return {id, id == 0 ? std::uint16_t{0} : wide.advance[id], space, space, true};
}

/// Characters that stay on one line with a number: "k = 2", "5 %", "3 µm", "20 °C".
bool stays_with_number(char32_t c) {
  return c == U'=' || c == U'%' || c == U'\u00B5' || c == U'\u00B0';
}

/// Chinese punctuation fills half of its square, so that no space follows it.
bool has_room_after(char32_t c) {
  constexpr std::u32string_view all = U"\u3002\uFF0C\uFF1B\uFF1A\u3001\uFF09\uFF1F\uFF01";
  return all.find(c) != std::u32string_view::npos;
}

}  // namespace

Expected<Glyphs> shape(std::string_view text, const Fonts& fonts, bool bold, std::string_view field,
                       Medium medium) {
  const Font& font = fonts.weight(bold);
  Glyphs out;
  out.reserve(text.size());
  char32_t last = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t at = i;
    const char32_t c = next_composed(text, i);
    if (c == U' ' && has_room_after(last)) continue;
    Glyph glyph = glyph_of(c, font, fonts.wide);
    const bool accent = c == acute_above;
    const bool over_a_letter = accent && bears_accent(last) && !glyph.wide && !out.back().wide &&
                               glyph.advance == 0;  // the canvas requires accents without advance
    glyph.character = c;
    if (glyph.id == 0 || (accent && !over_a_letter)) {
      if (medium == Medium::paper) return fail(unprintable(text.substr(at, i - at), c, field));
      glyph = foreign_glyph(c);
    } else if (accent) {
      glyph = accent_over(font, out.back().id, glyph.id);
      glyph.character = c;
    }
    if (!out.empty() && (glyph.wide || out.back().wide) && !begins_no_line(c) &&
        !ends_no_line(last))
      out.back().break_after = true;
    if (!out.empty() && out.back().space && stays_with_number(c)) out.back().break_after = false;
    if (glyph.space && last == U'=') glyph.break_after = false;
    out.push_back(glyph);
    last = c;
  }
  return out;
}

Expected<void> check_text(std::string_view text, const Fonts& fonts, std::string_view field) {
  const auto in_both = [&](char byte) {
    const auto c = static_cast<unsigned char>(byte);
    return c < 0x80 && !is_control(c) && fonts.regular.glyph(c) != 0 && fonts.bold.glyph(c) != 0;
  };
  if (std::all_of(text.begin(), text.end(), in_both)) return {};
  for (const bool bold : {false, true})
    if (auto glyphs = shape(text, fonts, bold, field); !glyphs) return fail(glyphs.error());
  return {};
}

std::string visible_text(std::string_view text, const Fonts& fonts) {
  if (check_text(text, fonts, "")) return std::string(text);
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t at = i;
    const char32_t c = next_composed(text, i);
    if (std::size_t behind = i; bears_accent(c) && next_character(text, behind) == acute_above)
      i = behind;
    const std::string_view part = text.substr(at, i - at);
    if (c == not_utf8)
      out += "<0x" + hex(static_cast<unsigned char>(part[0]), 2) + ">";
    else if (!check_text(part, fonts, ""))
      out += c == U'\n' || c == U'\t' || c == U'\r' ? " " : "<U+" + hex(c, 4) + ">";
    else
      out += part;
  }
  return out;
}

double width_of(const Glyph* begin, const Glyph* end) {
  long sum = 0;
  for (const Glyph* g = begin; g != end; ++g) sum += g->advance;
  return static_cast<double>(sum) / 1000.0;
}

double widest_word(const Glyphs& glyphs) {
  long widest = 0, word = 0;
  for (const Glyph& g : glyphs) {
    if (!g.space || !g.break_after) word += g.advance;
    widest = std::max(widest, word);
    if (g.break_after) word = 0;
  }
  return static_cast<double>(widest) / 1000.0;
}

std::vector<TextLine> wrap(const Glyphs& glyphs, double width) {
  const auto limit = std::lround(width * 1000.0);
  std::vector<TextLine> lines;
  std::size_t begin = 0;
  while (begin < glyphs.size()) {
    long sum = 0;
    std::size_t end = begin, divide = begin;
    while (end < glyphs.size() && (glyphs[end].space || sum + glyphs[end].advance <= limit)) {
      sum += glyphs[end].advance;
      ++end;
      if (glyphs[end - 1].break_after) divide = end;
    }
    if (end == begin) ++end;  // at least one glyph per line, even if too wide
    if (end < glyphs.size() && divide > begin) end = divide;
    std::size_t last = end;
    while (last > begin && glyphs[last - 1].space) --last;
    lines.push_back({begin, last, width_of(glyphs.data() + begin, glyphs.data() + last)});
    begin = end;
  }
  if (lines.empty()) lines.push_back({0, 0, 0.0});
  return lines;
}

Glyphs shortened(Glyphs glyphs, double width, const Font& font) {
  if (width_of(glyphs) <= width) return glyphs;
  const std::uint16_t id = font.glyph(U'\u2026');
  const double mark = id == 0 ? 0.0 : font.advance[id] / 1000.0;
  double sum = width_of(glyphs);
  while (!glyphs.empty() && sum + mark > width) {
    sum -= glyphs.back().advance / 1000.0;
    glyphs.pop_back();
  }
  if (id != 0) {
    glyphs.push_back({id, font.advance[id], false, false});
    glyphs.back().character = U'\u2026';
  }
  return glyphs;
}

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
