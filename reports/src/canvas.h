// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "nonio/reports/document.h"
#include "text.h"

namespace nonio::reports {

/// Writes PDF operators. Lengths in pt, y upwards. The graphics state is remembered, so that what
/// has not changed is not written again.
class Canvas {
 public:
  struct Point {
    double x, y;
  };
  std::string ops;

  void fill_colour(Colour);
  void stroke_colour(Colour);
  void line(double width, Dash dash = Dash::solid);
  void see_through(bool on);  ///< between see_through(true) and (false) areas let others shine

  void move_to(double x, double y);
  void line_to(double x, double y);
  void curve_to(double x1, double y1, double x2, double y2, double x3, double y3);
  void rectangle(double x, double y, double w, double h);
  void circle(double x, double y, double radius);
  void dots(std::span<const Point>, double diameter, Colour);  ///< as small as they can be written
  void close() { ops += "h\n"; }
  void stroke() { ops += "S\n"; }
  void fill() { ops += "f\n"; }
  void fill_and_stroke() { ops += "B\n"; }
  void close_fill_and_stroke() { ops += "b\n"; }
  void segment(double x1, double y1, double x2, double y2);
  void filled(double x, double y, double w, double h, Colour);

  /// Everything until `leave` is drawn inside the rectangle only.
  void clip(double x, double y, double w, double h);
  void leave();

  /// Baseline begins at x, y.
  void text(double x, double y, bool bold, double size, std::span<const Glyph>);
  /// The same upwards, for the titles of vertical axes.
  void text_upwards(double x, double y, bool bold, double size, std::span<const Glyph>);
  /// The same along a direction of length 1.
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
