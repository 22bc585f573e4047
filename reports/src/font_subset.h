// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// The TrueType font without the outlines of other glyphs than these (by number) and those that
/// they are composed of; numbers stay as they are. Only with what a PDF needs of it (ISO 32000-1,
/// 9.9) and its names, which hold the licence. Empty if that cannot be made from this file.
std::string font_subset(std::string_view font, const std::vector<char>& glyphs);

/// The font with the outlines of these glyphs, ready for one document; without a name if that
/// cannot be made.
Embedded embedded_part(const Font&, std::vector<char> used);

}  // namespace nonio::reports
