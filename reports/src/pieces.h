// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "axis_scale.h"
#include "canvas.h"
#include "nonio/reports/document.h"
#include "nonio/reports/picture.h"

namespace nonio::reports {

/// Upper left corner relative to an origin; y is negative downwards.
struct SignatureFrame {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
};

/// A strip without page breaks; origin in its upper left corner.
struct Piece {
  double height = 0.0;
  double gap = 0.0;  ///< space to the next strip on the page
  std::string ops{};
  bool with_next = false;
  bool new_page = false;
  std::optional<SignatureFrame> signature{};
};

/// A block as strips. `repeated` is printed on each further page that begins after piece
/// `rows_from`.
struct Laid {
  std::vector<Piece> pieces;
  std::vector<Piece> repeated{};
  std::size_t rows_from = 0;
};

/// Data to be embedded in a document.
struct Used {
  bool common_only = true;             ///< whether only glyphs in Font::common were used
  std::vector<std::uint16_t> wide;     ///< glyphs of Fonts::wide by their number in the document
  std::vector<std::uint16_t> numbers;  ///< document numbers by glyph; 0 if the glyph is not used
  std::vector<std::shared_ptr<const Picture>> pictures;
};

struct Context {
  const Style& style;
  const Fonts& fonts;
  double page_room;  ///< height between header and footer
  Used& used;
  Medium medium = Medium::paper;
};

struct SetText {
  Glyphs glyphs;
  std::vector<TextLine> lines;
  bool bold = false;
  double size = 0.0;

  double leading() const { return size * 1.3; }
  double height() const { return leading() * static_cast<double>(lines.size()); }
  /// Draws line `i` with its upper edge at y; align 0 left, 0.5 center, 1 right in `width`.
  void draw(Canvas&, std::size_t i, double x, double y, double width = 0.0,
            double align = 0.0) const;
  /// The first line has its upper edge at y.
  void draw_all(Canvas&, double x, double y, double width = 0.0, double align = 0.0) const;
};

/// Records the used glyphs, and replaces wide glyphs by their document numbers. set_text and
/// set_line call it.
void note_glyphs(const Context&, Glyphs&, bool bold);
Expected<SetText> set_text(const Context&, std::string_view text, bool bold, double size,
                           double width, std::string_view field);
/// One line, shortened with an ellipsis if necessary.
Expected<SetText> set_line(const Context&, std::string_view text, bool bold, double size,
                           double width, std::string_view field);

/// A disc, triangle, square or ring, distinguishable without color.
void draw_mark(Canvas&, const Style&, Level, double x, double y, double size);
Colour colour_of(const Style&, Level);

/// Draws the numbers of a horizontal axis without overlaps, and its title below.
Expected<void> draw_axis_text(Canvas&, const Context&, const AxisScale&, std::string_view title,
                              double left, double width, double top, double size,
                              std::string_view field);

Expected<Laid> lay_block(const Block&, double width, const Context&);
Expected<Laid> lay_table(const Table&, double width, const Context&, std::string_view field);
Expected<Laid> lay_bars(const BarChart&, double width, const Context&, std::string_view field);
Expected<Laid> lay_code(const Code&, double width, const Context&, std::string_view field);
Expected<Laid> lay_signature(const SignatureBox&, double width, const Context&,
                             std::string_view field);
Expected<Laid> lay_plot(const Plot&, double width, const Context&, std::string_view field);
/// Height of title and legend.
Expected<double> plot_top(const Plot&, double width, const Context&, std::string_view field);

}  // namespace nonio::reports
