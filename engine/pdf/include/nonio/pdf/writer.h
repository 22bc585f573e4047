// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Writes a new PDF from existing content streams of its pages.
namespace nonio::pdf {

/// The subset of a font that a document embeds. A glyph has the same number in all subsets of its
/// font.
struct EmbeddedFont {
  std::string name;                 ///< /BaseFont of the PDF: "ABCDEF+LiberationSans-Bold"
  std::size_t size = 0;             ///< size of the font file before compression, bytes
  std::string file_deflated;        ///< compressed font file, /FontFile2
  std::string widths;               ///< widths of the glyphs as the array /W of the PDF
  std::string to_unicode_deflated;  ///< compressed map from glyphs to characters, /ToUnicode
};

struct Font {
  /// Must outlive the call of `write`. Null is allowed only for /F3, which the document then lacks.
  const EmbeddedFont* embedded = nullptr;
  /// Bounding box of all glyphs (left, bottom, right, top), ascent, descent and height of capital
  /// letters, in 1/1000 of the font size.
  std::array<int, 4> box{};
  int ascent = 0, descent = 0, cap_height = 0;
  int stem = 80;  ///< thickness of vertical strokes, 1/1000 of the font size
};

/// An image from a PNG or JPEG file in the form that documents embed; it is prepared once for all
/// documents.
struct Picture {
  unsigned width = 0, height = 0;  ///< pixels
  /// Whether a pixel is one gray value instead of red, green and blue, 8 bits each.
  bool grey = false;
  bool jpeg = false;  ///< whether `colours` is a JPEG file, otherwise compressed rows
  std::string colours;
  /// Compressed rows of 8-bit opacity values; empty if the whole image is opaque.
  std::string opacity;
};

/// Frame of a visible signature: index of the page, and edges in pt. It is written to the
/// dictionary of the page (`signature_key`) for `reserve`.
struct SignaturePlace {
  std::size_t page = 0;
  double left = 0.0, low = 0.0, right = 0.0, high = 0.0;
};
/// Key of a page's dictionary: the frame of the signature, [left low right high] in pt.
inline constexpr const char* signature_key = "NonioSignature";

/// `pages` are content streams in which fonts are /F1 (regular), /F2 (bold) and /F3 (wide) with
/// glyph numbers of two bytes, pictures are /P0, /P1, ..., and /G1 is the graphics state for
/// translucent areas.
struct NewFile {
  std::string title, author, subject, language;
  std::string date;  ///< date of creation, YYYY-MM-DD; empty if not stated
  double width = 0.0, height = 0.0;
  double see_through = 1.0;  ///< opacity of areas drawn with /G1, 0 to 1
  std::array<Font, 3> fonts{};
  std::vector<std::shared_ptr<const Picture>> pictures;
  std::vector<std::string> pages;
  /// ICC profile of sRGB, for a PDF that is to be archived. If it is not empty, the PDF contains
  /// the profile, the document properties as XMP, and an identifier.
  std::string profile{};
  std::optional<SignaturePlace> signature{};
};

Expected<std::string> write(NewFile file);

}  // namespace nonio::pdf
