// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// Pages as content streams; fonts are /F1 (regular), /F2 (bold) and /F3 (wide) with glyph numbers
/// of two bytes, and /G1 is the graphics state for see-through areas.
struct PdfFile {
  std::string title, author, subject, language;
  std::string date;  ///< YYYY-MM-DD or empty
  double width = 0.0, height = 0.0;
  double see_through = 1.0;  ///< opacity of areas drawn under /G1
  bool common_only = false;  ///< every glyph is one of Font::common
  std::vector<char> wide;    ///< glyphs of Fonts::wide that are used; empty: none
  std::vector<std::string> pages;
};

Expected<std::string> write_pdf(const PdfFile&, const Fonts&);

}  // namespace nonio::reports
