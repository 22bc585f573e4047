// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::reports {

/// What a document embeds of a font; glyphs have the same numbers in every one of its subsets.
struct Embedded {
  std::string name;                 ///< of the PDF's BaseFont: "ABCDEF+LiberationSans-Bold"
  std::size_t size = 0;             ///< of the file before it was compressed
  std::string file_deflated;        ///< FontFile2
  std::string widths;               ///< the PDF's W array
  std::string to_unicode_deflated;  ///< ToUnicode
};

/// A TrueType font, already cut to the characters that are wanted, and everything of it that every
/// document needs: parsed and compressed once, then only copied.
struct Font {
  std::string bytes;                   ///< the font file
  std::vector<std::uint16_t> glyphs;   ///< by character; 0 where the font has none
  std::vector<std::uint16_t> advance;  ///< by glyph, 1/1000 of the font size
  std::array<int, 4> box{};            ///< 1/1000 of the font size, as the next three
  int ascent = 0, descent = 0, cap_height = 0;

  std::vector<char> common;  ///< by glyph: of a character that most documents have
  Embedded with_common, with_all;

  std::uint16_t glyph(char32_t c) const { return c < glyphs.size() ? glyphs[c] : 0; }
};

struct Fonts {
  Font regular, bold;
};

/// `name` is the file's, for messages and the PDF.
Expected<Font> parse_font(std::string bytes, std::string_view name);

/// The two fonts of a document. The last pair is remembered, so that only the first document of a
/// process (or of the process it was forked from) pays; what is given depends on the bytes alone.
Expected<std::shared_ptr<const Fonts>> shared_fonts(std::string_view regular_bytes,
                                                    std::string_view regular_name,
                                                    std::string_view bold_bytes,
                                                    std::string_view bold_name);

}  // namespace nonio::reports
