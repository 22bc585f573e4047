// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/writer.h"
#include "nonio/sdk/error.h"

namespace nonio::reports {

/// A TrueType font, reduced to required characters, with the parsed and compressed data that all
/// documents use.
struct Font {
  std::string name;  ///< file name, for messages and the PDF
  /// Those of the template, which must outlive the font: a Chinese font has 4 MB.
  std::string_view bytes;
  std::string directory;               ///< copy of the table directory, which has checksums
  std::vector<std::uint16_t> glyphs;   ///< by character; 0 if the font lacks the character
  std::vector<std::uint16_t> advance;  ///< by glyph, 1/1000 of the font size
  std::array<int, 4> box{};            ///< box and the next three members: 1/1000 of the font size
  int ascent = 0, descent = 0, cap_height = 0;
  int units = 1000;  ///< outline units per em

  std::vector<char> common;       ///< by glyph: whether its character is common in documents
  pdf::EmbeddedFont with_common;  ///< empty if documents embed only used glyphs
  /// Made when the first document needs it.
  struct Whole {
    std::once_flag made{};
    pdf::EmbeddedFont embedded{};
  };
  std::shared_ptr<Whole> whole = std::make_shared<Whole>();

  std::uint16_t glyph(char32_t c) const { return c < glyphs.size() ? glyphs[c] : 0; }
};

/// `wide` has characters missing in the other fonts, in particular Chinese, for both weights; may
/// be empty.
struct Fonts {
  Font regular, bold, wide;

  const Font& weight(bool is_bold) const { return is_bold ? bold : regular; }
};

struct FontFile {
  std::string_view bytes, name;
};

/// Does not set `with_common`.
Expected<Font> parse_font(FontFile);

/// Returns the font with all its glyphs, which rare characters need.
const pdf::EmbeddedFont& with_all(const Font& font);

/// Cached in the process for as long as the same templates are used.
Expected<std::shared_ptr<const Fonts>> shared_fonts(FontFile regular, FontFile bold,
                                                    FontFile wide = {});

}  // namespace nonio::reports
