// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/reports/font.h"
#include "nonio/reports/picture.h"

namespace nonio::reports {

/// Where a signature is shown, pt.
struct SignaturePlace {
  std::size_t page = 0;
  double left = 0.0, low = 0.0, right = 0.0, high = 0.0;
};

/// Pages as content streams; fonts are /F1 (regular), /F2 (bold) and /F3 (wide) with glyph numbers
/// of two bytes, /P0, /P1, ... are pictures, and /G1 is the graphics state for see-through areas.
struct PdfFile {
  std::string title, author, subject, language;
  std::string date;  ///< YYYY-MM-DD or empty
  double width = 0.0, height = 0.0;
  double see_through = 1.0;  ///< opacity of areas drawn under /G1
  bool common_only = false;  ///< every glyph is one of Font::common
  /// Glyphs of Fonts::wide by the numbers that the pages have for them; empty: none.
  std::vector<std::uint16_t> wide;
  std::vector<std::shared_ptr<const Picture>> pictures;
  std::vector<std::string> pages;
  std::string profile{};  ///< as in Document
  std::optional<SignaturePlace> signature{};
};

Expected<std::string> write_pdf(PdfFile, const Fonts&);

}  // namespace nonio::reports
