// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

struct Glyph {
  std::uint16_t id;
  std::uint16_t advance;             ///< 1/1000 of the font size
  bool space;                        ///< removable at the end of a line
  bool break_after;                  ///< line break opportunity
  bool wide = false;                 ///< from Fonts::wide
  std::int16_t shift = 0, rise = 0;  ///< offset of an accent, 1/1000 of the font size
  char32_t character = 0;
};
using Glyphs = std::vector<Glyph>;

/// A screen has additional fonts for missing characters.
enum class Medium : std::uint8_t { paper, screen };

/// NFC composition. An unprintable character is an error with `field`; on a screen its width is
/// estimated instead.
Expected<Glyphs> shape(std::string_view text, const Fonts&, bool bold, std::string_view field,
                       Medium = Medium::paper);

/// Width in units of the font size.
double width_of(const Glyph* begin, const Glyph* end);
inline double width_of(const Glyphs& g) { return width_of(g.data(), g.data() + g.size()); }

/// Width of the widest unbreakable part, in units of the font size.
double widest_word(const Glyphs&);

struct TextLine {
  std::size_t begin, end;  ///< glyph range without trailing spaces
  double width;            ///< in units of the font size
};

/// Breaks into lines of at most `width` (font size units); longer words are divided.
std::vector<TextLine> wrap(const Glyphs&, double width);

/// Shortens to `width` with an ellipsis if necessary.
Glyphs shortened(Glyphs, double width, const Font&);

inline constexpr char32_t not_utf8 = 0xFFFFFFFF;
inline constexpr char32_t acute_above = 0x0301;

/// Decodes a character and advances `i`. An invalid byte gives not_utf8 and is skipped.
char32_t next_character(std::string_view text, std::size_t& i);

/// Like next_character, with NFC composition of a letter and its marks.
char32_t next_composed(std::string_view text, std::size_t& i);

bool is_control(char32_t);

/// Letters (Latin, Greek, Cyrillic) over which a separate accent can be set.
bool bears_accent(char32_t);

/// Line-breaking restrictions next to ideographs (GB/T 15834: punctuation).
bool begins_no_line(char32_t);
bool ends_no_line(char32_t);

}  // namespace nonio::reports
