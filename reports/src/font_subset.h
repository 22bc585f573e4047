// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// The TrueType font with outlines of these glyphs and their components only; glyph numbers are
/// unchanged. It contains what a PDF needs (ISO 32000-1, 9.9), and the name table with the license.
/// Empty if not possible.
std::string font_subset(std::string_view font, const std::vector<char>& glyphs);

/// Like font_subset, but renumbered in the order of the list, followed by components. The first
/// must be glyph 0 of the font (missing character).
std::string font_part(std::string_view font, std::vector<std::uint16_t> glyphs);

/// The font part for one document; its name is empty if not possible.
pdf::EmbeddedFont embedded_part(const Font&, const std::vector<std::uint16_t>& glyphs);

}  // namespace nonio::reports
