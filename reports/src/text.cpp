// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "nonio/reports/text.h"

namespace nonio::reports {
namespace {

constexpr char32_t not_utf8 = 0xFFFFFFFF;

/// The next character; `i` moves behind it. What is not UTF-8 gives not_utf8 and moves by a byte.
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

bool is_control(char32_t c) { return c < 0x20 || (c >= 0x7F && c < 0xA0); }

std::string hex(std::uint32_t value, int digits) {
  std::array<char, 16> buffer{};
  auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, 16).ptr;
  std::string text(buffer.data(), end);
  for (char& c : text)
    if (c >= 'a') c = static_cast<char>(c - 'a' + 'A');
  while (text.size() < static_cast<std::size_t>(digits)) text.insert(0, 1, '0');
  return text;
}

Error unprintable(std::string_view text, std::size_t at, char32_t c, std::string_view field) {
  std::string what;
  if (c == not_utf8)
    what = "the byte 0x" + hex(static_cast<unsigned char>(text[at]), 2) + ", which is not UTF-8";
  else if (is_control(c))
    what = "the control character U+" + hex(c, 4);
  else {
    std::size_t end = at;
    next_character(text, end);
    what = "the character \"" + std::string(text.substr(at, end - at)) + "\" (U+" + hex(c, 4) +
           "), which the report's fonts do not have";
  }
  return Error{std::string(field) + ": printable text was expected, found " + what};
}

}  // namespace

Expected<Glyphs> shape(std::string_view text, const Font& font, std::string_view field) {
  Glyphs out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t at = i;
    const auto byte = static_cast<unsigned char>(text[i]);
    const char32_t c = byte < 0x80 ? (++i, byte) : next_character(text, i);
    const std::uint16_t id = c == not_utf8 || is_control(c) ? 0 : font.glyph(c);
    if (id == 0) return fail(unprintable(text, at, c, field));
    const bool space = c == U' ';
    out.push_back({id, font.advance[id], space, space || c == U'-' || c == U'\u2013'});
  }
  return out;
}

Expected<void> check_text(std::string_view text, const Fonts& fonts, std::string_view field) {
  for (const Font* font : {&fonts.regular, &fonts.bold})
    if (auto glyphs = shape(text, *font, field); !glyphs) return fail(glyphs.error());
  return {};
}

std::string visible_text(std::string_view text, const Fonts& fonts) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t at = i;
    const char32_t c = next_character(text, i);
    if (c == not_utf8)
      out += "<0x" + hex(static_cast<unsigned char>(text[at]), 2) + ">";
    else if (is_control(c) || fonts.regular.glyph(c) == 0 || fonts.bold.glyph(c) == 0)
      out += c == U'\n' || c == U'\t' || c == U'\r' ? " " : "<U+" + hex(c, 4) + ">";
    else
      out += text.substr(at, i - at);
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
    if (!g.space) word += g.advance;
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
    if (end == begin) ++end;  // not even one fits: one nevertheless
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
  if (id != 0) glyphs.push_back({id, font.advance[id], false, false});
  return glyphs;
}

}  // namespace nonio::reports
