// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

struct Glyph {
  std::uint16_t id;
  std::uint16_t advance;             ///< 1/1000 of the font size
  bool space;                        ///< may vanish at the end of a line
  bool break_after;                  ///< a line may end here
  bool wide = false;                 ///< of Fonts::wide
  std::int16_t shift = 0, rise = 0;  ///< position of an accent, 1/1000 of the font size
  char32_t character = 0;
};
using Glyphs = std::vector<Glyph>;

/// Paper has the fonts of the document, a screen further ones for characters that those lack.
enum class Medium : std::uint8_t { paper, screen };

/// UTF-8 to glyphs; letters and their marks are composed (NFC). What cannot be printed is an error
/// that names the character and `field`; nothing is left out in silence. On a screen nothing is an
/// error: the width of a character that the fonts lack is estimated.
Expected<Glyphs> shape(std::string_view text, const Fonts&, bool bold, std::string_view field,
                       Medium = Medium::paper);

/// In units of the font size.
double width_of(const Glyph* begin, const Glyph* end);
inline double width_of(const Glyphs& g) { return width_of(g.data(), g.data() + g.size()); }

/// The widest part that no space or hyphen divides, in units of the font size.
double widest_word(const Glyphs&);

struct TextLine {
  std::size_t begin, end;  ///< of the glyphs, without the spaces at its end
  double width;            ///< in units of the font size
};

/// Lines no wider than `width` (in units of the font size); a word that is wider is divided.
std::vector<TextLine> wrap(const Glyphs&, double width);

/// At most `width` wide, with an ellipsis if something had to go.
Glyphs shortened(Glyphs, double width, const Font&);

}  // namespace nonio::reports
