// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/writer.h"
#include "nonio/sdk/error.h"

namespace nonio::reports {

/// A TrueType font, already cut to the characters that are required, and everything of it that
/// every document needs: parsed and compressed once, then only copied.
struct Font {
  std::string name;                    ///< its file, for messages and the PDF
  std::string bytes;                   ///< the font file
  std::vector<std::uint16_t> glyphs;   ///< by character; 0 where the font has none
  std::vector<std::uint16_t> advance;  ///< by glyph, 1/1000 of the font size
  std::array<int, 4> box{};            ///< 1/1000 of the font size, as the next three
  int ascent = 0, descent = 0, cap_height = 0;
  int units = 1000;  ///< of its outlines, per font size

  std::vector<char> common;  ///< by glyph: of a character that most documents have
  pdf::EmbeddedFont with_common,
      with_all;  ///< empty in a font of which a document embeds what it uses

  std::uint16_t glyph(char32_t c) const { return c < glyphs.size() ? glyphs[c] : 0; }
};

/// `wide` is taken for characters that the other two lack, Chinese above all, in both weights; it
/// may be empty.
struct Fonts {
  Font regular, bold, wide;

  const Font& weight(bool is_bold) const { return is_bold ? bold : regular; }
};

struct FontFile {
  std::string_view bytes, name;
};

/// Without `with_common` and `with_all`.
Expected<Font> parse_font(FontFile);

/// The fonts of a document. The last ones are remembered, so that only the first document of a
/// process (or of the process it was forked from) pays; what is given depends on the bytes alone.
Expected<std::shared_ptr<const Fonts>> shared_fonts(FontFile regular, FontFile bold,
                                                    FontFile wide = {});

}  // namespace nonio::reports
