// SPDX-License-Identifier: Apache-2.0
#include "svg_canvas.h"

#include <cmath>

#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"

namespace nonio::reports {
namespace {

std::string length(double v) {
  std::string out = fixed_text(v, 2);
  while (out.back() == '0') out.pop_back();
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

std::string attribute(const char* name, std::string_view value) {
  return ' ' + std::string(name) + "=\"" + escaped_markup(value, Markup::attribute) + '"';
}

const char* dash_array(Dash of) {
  switch (of) {
    case Dash::dashed:
      return "6 4";
    case Dash::dotted:
      return "2 3";
    case Dash::dash_dot:
      return "9 3 2 3";
    case Dash::solid:
      break;
  }
  return "";
}

}  // namespace

void SvgCanvas::point(char command, double x, double y) {
  path_ += command + length(x) + ' ' + length(-y);
}

void SvgCanvas::rectangle(double x, double y, double w, double h) {
  point('M', x, y);
  path_ += 'h' + length(w) + 'v' + length(-h) + 'h' + length(-w) + 'Z';
}

void SvgCanvas::circle(double x, double y, double radius) {
  point('M', x - radius, y);
  const std::string arc = 'a' + length(radius) + ' ' + length(radius) + " 0 1 0 ";
  path_ += arc + length(2 * radius) + " 0" + arc + length(-2 * radius) + " 0Z";
}

void SvgCanvas::dots(std::span<const Point> points, double diameter, Colour c) {
  stroke_colour(c);
  line(diameter);
  for (const auto& [x, y] : points) {
    point('M', x, y);
    path_ += "h0";
  }
  paint(false, true, " stroke-linecap=\"round\"");
}

void SvgCanvas::paint(bool fill, bool stroke, const char* more) {
  if (path_.empty()) return;
  elements += "<path d=\"" + path_ + '"' + attribute("fill", fill ? colour(fill_) : "none");
  if (fill && see_through_) elements += attribute("fill-opacity", length(opacity_));
  if (stroke) {
    elements += attribute("stroke", colour(stroke_)) + attribute("stroke-width", length(width_));
    if (dash_ != Dash::solid) elements += attribute("stroke-dasharray", dash_array(dash_));
    if (round_) elements += attribute("stroke-linejoin", "round");
  }
  (elements += more) += "/>";
  path_.clear();
}

std::string SvgCanvas::colour(Colour c) const {
  for (const NamedColour& named : colours_)
    if (named.colour == c) return "var(--" + std::string(named.name) + ')';
  const auto part = [](float v) { return std::to_string(std::lround(255 * v)); };
  return "rgb(" + part(c.red) + ',' + part(c.green) + ',' + part(c.blue) + ')';
}

void SvgCanvas::write_text(const std::string& place, bool bold, double size,
                           std::span<const Glyph> glyphs) {
  if (glyphs.empty()) return;
  std::string text;
  for (const Glyph& g : glyphs) append_utf8(text, g.character);
  elements += "<text" + place + attribute("font-size", length(size)) +
              attribute("fill", colour(fill_)) + (bold ? " font-weight=\"bold\">" : ">") +
              escaped_markup(text, Markup::attribute) + "</text>";
}

void SvgCanvas::text(double x, double y, bool bold, double size, std::span<const Glyph> glyphs) {
  write_text(attribute("x", length(x)) + attribute("y", length(-y)), bold, size, glyphs);
}

void SvgCanvas::text_upwards(double x, double y, bool bold, double size,
                             std::span<const Glyph> glyphs) {
  write_text(attribute("transform", "translate(" + length(x) + ' ' + length(-y) + ") rotate(-90)"),
             bold, size, glyphs);
}

void SvgCanvas::begin_item(std::string_view title, std::string_view link) {
  linked_ = !link.empty();
  has_links = has_links || linked_;
  elements += linked_ ? "<a" + attribute("href", link) + '>' : "<g>";
  if (!title.empty()) elements += "<title>" + escaped_markup(title, Markup::attribute) + "</title>";
}

void SvgCanvas::end_item() {
  elements += linked_ ? "</a>" : "</g>";
  linked_ = false;
}

void SvgCanvas::begin_part(const char* name) { elements += "<g" + attribute("class", name) + '>'; }

}  // namespace nonio::reports
