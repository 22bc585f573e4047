// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "nonio/reports/document.h"
#include "text.h"

namespace nonio::reports {

/// Drawing surface of charts. Lengths in pt or px, y upwards. move_to, rectangle or circle begin a
/// path; stroke or fill paint it.
class Canvas {
 public:
  struct Point {
    double x, y;
  };
  virtual ~Canvas() = default;

  virtual void fill_colour(Colour) = 0;
  virtual void stroke_colour(Colour) = 0;
  virtual void line(double width, Dash dash = Dash::solid) = 0;
  /// While true, filled areas are translucent.
  virtual void see_through(bool on) = 0;
  virtual void round_joins() = 0;  ///< avoids spikes at corners

  virtual void move_to(double x, double y) = 0;
  virtual void line_to(double x, double y) = 0;
  virtual void rectangle(double x, double y, double w, double h) = 0;
  virtual void circle(double x, double y, double radius) = 0;
  virtual void close() = 0;
  virtual void stroke() = 0;
  virtual void fill() = 0;
  virtual void fill_and_stroke() = 0;
  virtual void close_fill_and_stroke() = 0;
  virtual void dots(std::span<const Point>, double diameter, Colour) = 0;
  void segment(double x1, double y1, double x2, double y2);
  void filled(double x, double y, double w, double h, Colour);

  /// Clips drawing to the rectangle until `leave`.
  virtual void clip(double x, double y, double w, double h) = 0;
  virtual void leave() = 0;

  /// x, y: start of the baseline.
  virtual void text(double x, double y, bool bold, double size, std::span<const Glyph>) = 0;
  /// For titles of vertical axes.
  virtual void text_upwards(double x, double y, bool bold, double size, std::span<const Glyph>) = 0;

  /// Groups drawing until `end_item`, with a tooltip and a link (may be empty); no effect in a PDF.
  virtual void begin_item(std::string_view title, std::string_view link);
  virtual void end_item();
  /// Names what is drawn until `end_item`, for scripts of a page; no effect in a PDF.
  virtual void begin_part(const char* name);
};

/// Writes PDF operators, omitting state changes without effect.
class PdfCanvas final : public Canvas {
 public:
  std::string ops;

  void fill_colour(Colour) override;
  void stroke_colour(Colour) override;
  void line(double width, Dash dash = Dash::solid) override;
  void see_through(bool on) override;
  void round_joins() override { ops += "1 j\n"; }

  void move_to(double x, double y) override;
  void line_to(double x, double y) override;
  void curve_to(double x1, double y1, double x2, double y2, double x3, double y3);
  void rectangle(double x, double y, double w, double h) override;
  void circle(double x, double y, double radius) override;
  void dots(std::span<const Point>, double diameter, Colour) override;
  void close() override { ops += "h\n"; }
  void stroke() override { ops += "S\n"; }
  void fill() override { ops += "f\n"; }
  void fill_and_stroke() override { ops += "B\n"; }
  void close_fill_and_stroke() override { ops += "b\n"; }

  void clip(double x, double y, double w, double h) override;
  void leave() override;

  void text(double x, double y, bool bold, double size, std::span<const Glyph>) override;
  void text_upwards(double x, double y, bool bold, double size, std::span<const Glyph>) override;
  /// Text along a unit vector.
  void text_along(double x, double y, double cosine, double sine, bool bold, double size,
                  std::span<const Glyph>);
  void picture(long number, double x, double y, double w, double h);
  void place(double x, double y, const std::string& operators);

 private:
  struct State {
    Colour fill{-1, -1, -1}, stroke{-1, -1, -1};
    double width = -1;
    Dash dash = Dash::solid;
    bool see_through = false;
    int font = 0;  ///< 1 regular, 2 bold, 3 wide
    double size = -1;
  };
  void number(double value);
  void colour(Colour, const char* op);
  void show(bool bold, double size, std::span<const Glyph>);
  void font(int number, double size);
  void shown(std::span<const Glyph>);
  State state_, kept_;
};

}  // namespace nonio::reports
