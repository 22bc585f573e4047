// SPDX-License-Identifier: Apache-2.0
#include "canvas.h"

#include <array>

#include "nonio/pdf/bytes.h"

namespace nonio::reports {

void Canvas::begin_item(std::string_view, std::string_view) {}
void Canvas::end_item() {}
void Canvas::begin_part(const char*) {}

void PdfCanvas::number(double value) { pdf::append_real(ops, value, ' '); }

void PdfCanvas::colour(Colour c, const char* op) {
  for (const float part : {c.red, c.green, c.blue}) number(part);
  ops += op;
}

void PdfCanvas::fill_colour(Colour c) {
  if (c == state_.fill) return;
  state_.fill = c;
  colour(c, "rg\n");
}

void PdfCanvas::stroke_colour(Colour c) {
  if (c == state_.stroke) return;
  state_.stroke = c;
  colour(c, "RG\n");
}

void PdfCanvas::line(double width, Dash dash) {
  if (width != state_.width) {
    number(width);
    ops += "w\n";
    state_.width = width;
  }
  if (dash == state_.dash) return;
  state_.dash = dash;
  switch (dash) {
    case Dash::solid:
      ops += "[] 0 d\n";
      break;
    case Dash::dashed:
      ops += "[4 2] 0 d\n";
      break;
    case Dash::dotted:
      ops += "[1 1.6] 0 d\n";
      break;
    case Dash::dash_dot:
      ops += "[6 2 1 2] 0 d\n";
      break;
  }
}

void PdfCanvas::see_through(bool on) {
  if (on == state_.see_through) return;
  if (on) {
    kept_ = state_;
    ops += "q /G1 gs\n";
    state_.see_through = true;
  } else {
    ops += "Q\n";
    state_ = kept_;
  }
}

void PdfCanvas::move_to(double x, double y) {
  number(x);
  number(y);
  ops += "m\n";
}

void PdfCanvas::line_to(double x, double y) {
  number(x);
  number(y);
  ops += "l\n";
}

void PdfCanvas::curve_to(double x1, double y1, double x2, double y2, double x3, double y3) {
  for (const double v : {x1, y1, x2, y2, x3, y3}) number(v);
  ops += "c\n";
}

void PdfCanvas::rectangle(double x, double y, double w, double h) {
  for (const double v : {x, y, w, h}) number(v);
  ops += "re\n";
}

void PdfCanvas::circle(double x, double y, double radius) {
  const double c = radius * 0.5523;  // 4 (sqrt 2 - 1)/3: Bezier approximation of a quarter circle
  move_to(x + radius, y);
  curve_to(x + radius, y + c, x + c, y + radius, x, y + radius);
  curve_to(x - c, y + radius, x - radius, y + c, x - radius, y);
  curve_to(x - radius, y - c, x - c, y - radius, x, y - radius);
  curve_to(x + c, y - radius, x + radius, y - c, x + radius, y);
}

void PdfCanvas::dots(std::span<const Point> points, double diameter, Colour c) {
  stroke_colour(c);
  line(diameter);
  ops += "1 J\n";  // a zero-length line with round caps is a dot (ISO 32000-1, 8.5.3.2)
  for (const auto& [x, y] : points) {
    move_to(x, y);
    line_to(x, y);
  }
  stroke();
  ops += "0 J\n";
}

void Canvas::segment(double x1, double y1, double x2, double y2) {
  move_to(x1, y1);
  line_to(x2, y2);
  stroke();
}

void Canvas::filled(double x, double y, double w, double h, Colour c) {
  fill_colour(c);
  rectangle(x, y, w, h);
  fill();
}

void PdfCanvas::clip(double x, double y, double w, double h) {
  ops += "q\n";
  rectangle(x, y, w, h);
  ops += "W n\n";
}

void PdfCanvas::leave() {
  ops += "Q\n";
  state_ = State{};
}

void PdfCanvas::font(int which, double size) {
  if (which == state_.font && size == state_.size) return;
  ops += "/F";
  pdf::append_int(ops, which);
  ops += ' ';
  number(size);
  ops += "Tf ";
  state_.font = which;
  state_.size = size;
}

/// Runs of one font are one operation; accents are separate.
void PdfCanvas::show(bool bold, double size, std::span<const Glyph> glyphs) {
  const auto is_accent = [](const Glyph& g) { return g.shift != 0 || g.rise != 0; };
  for (std::size_t i = 0; i < glyphs.size();) {
    const Glyph& first = glyphs[i];
    font(first.wide ? 3 : bold ? 2 : 1, size);
    if (is_accent(first)) {
      number(size * first.rise / 1000.0);
      ops += "Ts [";
      number(-first.shift);
      shown(glyphs.subspan(i, 1));
      number(first.shift);
      ops += "] TJ 0 Ts ";
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < glyphs.size() && glyphs[end].wide == first.wide && !is_accent(glyphs[end])) ++end;
    const bool outlined = bold && first.wide;
    if (outlined) {  // the wide font has no bold face
      stroke_colour(state_.fill);
      line(0.03 * size);
      ops += "2 Tr ";
    }
    shown(glyphs.subspan(i, end - i));
    ops += outlined ? " Tj 0 Tr " : " Tj ";
    i = end;
  }
  ops += "ET\n";
}

void PdfCanvas::shown(std::span<const Glyph> glyphs) {
  ops += '(';
  std::array<char, 256> part;  // twice as fast as appending bytes
  std::size_t n = 0;
  for (const Glyph& g : glyphs) {
    for (const int byte : {g.id >> 8, g.id & 0xFF}) {
      const char c = static_cast<char>(byte);
      if (c == '(' || c == ')' || c == '\\' || c == '\r') part[n++] = '\\';
      part[n++] = c == '\r' ? 'r' : c;
    }
    if (n + 4 <= part.size()) continue;
    ops.append(part.data(), n);
    n = 0;
  }
  ops.append(part.data(), n);
  ops += ')';
}

void PdfCanvas::text(double x, double y, bool bold, double size, std::span<const Glyph> glyphs) {
  if (glyphs.empty()) return;
  ops += "BT ";
  number(x);
  number(y);
  ops += "Td ";
  show(bold, size, glyphs);
}

void PdfCanvas::text_upwards(double x, double y, bool bold, double size,
                             std::span<const Glyph> glyphs) {
  if (glyphs.empty()) return;
  ops += "BT 0 1 -1 0 ";
  number(x);
  number(y);
  ops += "Tm ";
  show(bold, size, glyphs);
}

void PdfCanvas::text_along(double x, double y, double cosine, double sine, bool bold, double size,
                           std::span<const Glyph> glyphs) {
  if (glyphs.empty()) return;
  ops += "BT ";
  for (const double v : {cosine, sine, -sine, cosine, x, y}) number(v);
  ops += "Tm ";
  show(bold, size, glyphs);
}

void PdfCanvas::picture(long which, double x, double y, double w, double h) {
  ops += "q ";
  number(w);
  ops += "0 0 ";
  for (const double v : {h, x, y}) number(v);
  ops += "cm /P";
  pdf::append_int(ops, which);
  ops += " Do Q\n";
}

void PdfCanvas::place(double x, double y, const std::string& operators) {
  if (operators.empty()) return;
  ops += "q 1 0 0 1 ";
  number(x);
  number(y);
  ops += "cm\n";
  ops += operators;
  ops += "Q\n";
}

}  // namespace nonio::reports
