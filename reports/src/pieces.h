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

/// The frame of a signature, from an origin to its upper left corner; y downwards is negative.
struct SignatureFrame {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
};

/// A strip of the document that no page break divides; its origin is its upper left corner.
struct Piece {
  double height = 0.0;
  double gap = 0.0;  ///< below it, where something follows on the same page
  std::string ops{};
  bool with_next = false;  ///< not the last one on a page
  bool new_page = false;   ///< first on its page
  std::optional<SignatureFrame> signature{};
};

/// A block as strips; `repeated` is printed again at the top of each further page that begins after
/// the piece `rows_from`.
struct Laid {
  std::vector<Piece> pieces;
  std::vector<Piece> repeated{};
  std::size_t rows_from = 0;
};

/// What a document embeds.
struct Used {
  bool common_only = true;             ///< no glyph was set that is not one of Font::common
  std::vector<std::uint16_t> wide;     ///< glyphs of Fonts::wide by their number in the document
  std::vector<std::uint16_t> numbers;  ///< the other way round; 0: not used yet
  std::vector<std::shared_ptr<const Picture>> pictures;
};

struct Context {
  const Style& style;
  const Fonts& fonts;
  double page_room;  ///< height between head and foot
  Used& used;
  Medium medium = Medium::paper;
};

/// A text that is set at one size, in lines.
struct SetText {
  Glyphs glyphs;
  std::vector<TextLine> lines;
  bool bold = false;
  double size = 0.0;

  double leading() const { return size * 1.3; }
  double height() const { return leading() * static_cast<double>(lines.size()); }
  /// Line `i` with its upper edge at y; align 0 left, 0.5 centre, 1 right within `width`.
  void draw(Canvas&, std::size_t i, double x, double y, double width = 0.0,
            double align = 0.0) const;
  /// All lines, the first with its upper edge at y.
  void draw_all(Canvas&, double x, double y, double width = 0.0, double align = 0.0) const;
};

/// For text that is set in another way than by the next two; the document's numbers of glyphs.
void note_glyphs(const Context&, Glyphs&, bool bold);
Expected<SetText> set_text(const Context&, std::string_view text, bool bold, double size,
                           double width, std::string_view field);
/// In one line, with an ellipsis if it is too long for it.
Expected<SetText> set_line(const Context&, std::string_view text, bool bold, double size,
                           double width, std::string_view field);

/// A filled sign: a disc, a triangle, a square or a ring, distinct without colour.
void draw_mark(Canvas&, const Style&, Level, double x, double y, double size);
Colour colour_of(const Style&, Level);

/// The numbers of a horizontal axis from `left` over `width`, those that would touch the one before
/// left out, and below them its title.
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
/// The height that its title and legend take.
Expected<double> plot_top(const Plot&, double width, const Context&, std::string_view field);

}  // namespace nonio::reports
