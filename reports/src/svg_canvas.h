// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "canvas.h"
#include "nonio/reports/drawing.h"

namespace nonio::reports {

/// Writes SVG elements without style attributes, which the pages' content security policy forbids.
class SvgCanvas final : public Canvas {
 public:
  SvgCanvas(std::span<const NamedColour> colours, double opacity)
      : colours_(colours), opacity_(opacity) {}
  std::string elements;
  bool has_links = false;

  void fill_colour(Colour c) override { fill_ = c; }
  void stroke_colour(Colour c) override { stroke_ = c; }
  void line(double width, Dash dash = Dash::solid) override { width_ = width, dash_ = dash; }
  void see_through(bool on) override { see_through_ = on; }
  void round_joins() override { round_ = true; }

  void move_to(double x, double y) override { point('M', x, y); }
  void line_to(double x, double y) override { point('L', x, y); }
  void rectangle(double x, double y, double w, double h) override;
  void circle(double x, double y, double radius) override;
  void close() override { path_ += 'Z'; }
  void stroke() override { paint(false, true); }
  void fill() override { paint(true, false); }
  void fill_and_stroke() override { paint(true, true); }
  void close_fill_and_stroke() override { close(), paint(true, true); }
  void dots(std::span<const Point>, double diameter, Colour) override;

  /// Not needed, because ranges of web charts contain all data.
  void clip(double, double, double, double) override {}
  void leave() override { round_ = false; }

  void text(double x, double y, bool bold, double size, std::span<const Glyph>) override;
  void text_upwards(double x, double y, bool bold, double size, std::span<const Glyph>) override;
  void begin_item(std::string_view title, std::string_view link) override;
  void end_item() override;
  void begin_part(const char* name) override;

 private:
  void point(char command, double x, double y);
  void paint(bool fill, bool stroke, const char* more = "");
  std::string colour(Colour) const;
  void write_text(const std::string& place, bool bold, double size, std::span<const Glyph>);

  std::span<const NamedColour> colours_;
  double opacity_;
  Colour fill_{}, stroke_{};
  double width_ = 1.0;
  Dash dash_ = Dash::solid;
  bool see_through_ = false, round_ = false, linked_ = false;
  std::string path_;
};

}  // namespace nonio::reports
