// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// A new PDF from pages that are drawn already. libharu has its one home here.
namespace nonio::pdf {

/// What a document embeds of a font; glyphs have the same numbers in every one of its subsets.
struct EmbeddedFont {
  std::string name;                 ///< of the PDF's BaseFont: "ABCDEF+LiberationSans-Bold"
  std::size_t size = 0;             ///< of the file before it was compressed
  std::string file_deflated;        ///< FontFile2
  std::string widths;               ///< the PDF's W array
  std::string to_unicode_deflated;  ///< ToUnicode
};

struct Font {
  const EmbeddedFont* embedded = nullptr;  ///< outlives the call; null: there is no such font
  std::array<int, 4> box{};                ///< 1/1000 of the font size, as the next three
  int ascent = 0, descent = 0, cap_height = 0;
  int stem = 80;  ///< thickness of vertical strokes, 1/1000 of the font size
};

/// A PNG or JPEG file as documents hold it: decoded and compressed once, then only copied.
struct Picture {
  unsigned width = 0, height = 0;  ///< pixels
  bool grey = false;               ///< else red, green, blue; 8 bits each
  bool jpeg = false;               ///< `colours` is the file; else deflated rows
  std::string colours;
  std::string opacity;  ///< deflated rows of 8 bits; empty where nothing shines through
};

/// Where a signature is shown, pt. It is in the page's dictionary (`signature_key`), for `reserve`.
struct SignaturePlace {
  std::size_t page = 0;
  double left = 0.0, low = 0.0, right = 0.0, high = 0.0;
};
/// Of the page's dictionary: the corners of the frame, [left low right high] in pt.
inline constexpr const char* signature_key = "NonioSignature";

/// Pages as content streams; fonts are /F1 (regular), /F2 (bold) and /F3 (wide) with glyph numbers
/// of two bytes, /P0, /P1, ... are pictures, and /G1 is the graphics state for see-through areas.
struct NewFile {
  std::string title, author, subject, language;
  std::string date;  ///< YYYY-MM-DD or empty
  double width = 0.0, height = 0.0;
  double see_through = 1.0;  ///< opacity of areas drawn under /G1
  std::array<Font, 3> fonts{};
  std::vector<std::shared_ptr<const Picture>> pictures;
  std::vector<std::string> pages;
  /// An ICC profile of sRGB: the file is to be kept for long, and states its colours, its
  /// properties also as XMP, and an identifier.
  std::string profile{};
  std::optional<SignaturePlace> signature{};
};

Expected<std::string> write(NewFile file);

}  // namespace nonio::pdf
