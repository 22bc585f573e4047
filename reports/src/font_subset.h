// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// The TrueType font without the outlines of other glyphs than these (by number) and those that
/// they are composed of; numbers stay as they are. Only with what a PDF needs of it (ISO 32000-1,
/// 9.9) and its names, which hold the licence. Empty if that cannot be made from this file.
std::string font_subset(std::string_view font, const std::vector<char>& glyphs);

/// The same with these glyphs only, numbered in the order of the list, followed by the glyphs that
/// they are composed of. The first is the font's glyph 0, for characters that it does not have.
std::string font_part(std::string_view font, std::vector<std::uint16_t> glyphs);

/// The part for one document; without a name if that cannot be made.
pdf::EmbeddedFont embedded_part(const Font&, const std::vector<std::uint16_t>& glyphs);

}  // namespace nonio::reports
