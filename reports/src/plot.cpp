// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "nonio/reports/drawing.h"
#include "pieces.h"
#include "svg_canvas.h"

namespace nonio::reports {
namespace {

using Curve = Plot::Curve;
constexpr double largest_drawn = 1e300;  // differences of two values remain finite

bool drawable(double v) { return std::fabs(v) < largest_drawn; }

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double v) {
    if (!drawable(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return !(low <= high); }
};

struct Frame {
  double x, y, w, h;
  AxisScale across, up;
  double px(double v) const { return x + w * across.at(v); }
  double py(double v) const { return y + h * up.at(v); }
};

void draw_marker(Canvas& canvas, Marker marker, double x, double y, double r, Colour colour,
                 double outline = 0.6, Dash dashes = Dash::solid) {
  canvas.stroke_colour(colour);
  canvas.line(outline, dashes);
  switch (marker) {
    case Marker::none:
      return;
    case Marker::up:
      canvas.fill_colour(colour);
      canvas.move_to(x - r, y - 0.75 * r);
      canvas.line_to(x + r, y - 0.75 * r);
      canvas.line_to(x, y + r);
      canvas.close_fill_and_stroke();
      return;
    case Marker::down:
      canvas.fill_colour({1, 1, 1});
      canvas.move_to(x - r, y + 0.75 * r);
      canvas.line_to(x + r, y + 0.75 * r);
      canvas.line_to(x, y - r);
      canvas.close_fill_and_stroke();
      return;
    case Marker::dot:
    case Marker::ring:
      canvas.fill_colour(marker == Marker::dot ? colour : Colour{1, 1, 1});
      canvas.circle(x, y, 0.8 * r);
      canvas.fill_and_stroke();
      return;
    case Marker::square:
      canvas.fill_colour(colour);
      canvas.rectangle(x - 0.75 * r, y - 0.75 * r, 1.5 * r, 1.5 * r);
      canvas.fill_and_stroke();
      return;
    case Marker::around:
      canvas.line(0.9);
      canvas.circle(x, y, r);
      canvas.stroke();
      return;
  }
}

using Point = Canvas::Point;

/// Dots are drawn in one operation, which needs much fewer bytes.
void draw_markers(Canvas& canvas, Marker marker, const std::vector<Point>& points, double r,
                  Colour colour) {
  constexpr double outline = 0.6;
  if (marker == Marker::dot) return canvas.dots(points, 1.6 * r + outline, colour);
  for (const auto& [x, y] : points) draw_marker(canvas, marker, x, y, r, colour);
}

/// Of many points of an unbroken part at one x, the first, the extremes and the last are kept,
/// which look the same.
void thin_out(std::vector<Point>& points) {
  constexpr double place = 0.4;
  if (points.size() < 400) return;
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t end = i, low = i, high = i;
    while (end < points.size() && std::fabs(points[end].x - points[i].x) < place) {
      if (points[end].y < points[low].y) low = end;
      if (points[end].y > points[high].y) high = end;
      ++end;
    }
    std::vector<std::size_t> kept = {i, std::min(low, high), std::max(low, high), end - 1};
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const std::size_t k : kept) out.push_back(points[k]);
    i = end;
  }
  points = std::move(out);
}

std::vector<std::vector<Point>> stretches(const Frame& frame, const std::vector<double>& x,
                                          const std::vector<double>& y) {
  std::vector<std::vector<Point>> out(1);
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (drawable(x[i]) && drawable(y[i]))
      out.back().push_back({frame.px(x[i]), frame.py(y[i])});
    else if (!out.back().empty())
      out.emplace_back();
  }
  for (auto& stretch : out) thin_out(stretch);
  return out;
}

void path(Canvas& canvas, const std::vector<Point>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    i == 0 ? canvas.move_to(points[i].x, points[i].y) : canvas.line_to(points[i].x, points[i].y);
}

void draw_line(Canvas& canvas, const Frame& frame, const Curve& curve) {
  const auto parts = stretches(frame, curve.x, curve.y);
  if (curve.width > 0) {
    canvas.stroke_colour(curve.colour);
    canvas.line(curve.width, curve.dash);
    bool any = false;
    for (const auto& part : parts)
      if (part.size() > 1) path(canvas, part), any = true;
    if (any) canvas.stroke();
    canvas.line(curve.width);
  }
  const double spacing = frame.w / static_cast<double>(std::max<std::size_t>(1, curve.x.size()));
  const double apart = spacing < 1.8 * curve.marker_size ? 14.0 : 0.0;  // marker spacing, pt
  double last = -1e9;
  std::vector<Point> marked;
  for (const auto& part : parts)
    for (const Point& p : part) {
      if (curve.marker == Marker::none && part.size() > 1) break;
      if (std::fabs(p.x - last) < apart) continue;
      last = p.x;
      marked.push_back(p);
    }
  draw_markers(canvas, curve.marker == Marker::none ? Marker::dot : curve.marker, marked,
               curve.marker_size, curve.colour);
}

void draw_band(Canvas& canvas, const Frame& frame, const Curve& curve) {
  std::vector<double> one = curve.y, other = curve.y2;
  for (std::size_t i = 0; i < one.size() && i < other.size(); ++i)
    if (!drawable(one[i]) || !drawable(other[i])) one[i] = other[i] = std::nan("");
  const auto upper = stretches(frame, curve.x, one), lower = stretches(frame, curve.x, other);
  canvas.see_through(true);
  canvas.fill_colour(curve.colour);
  for (std::size_t k = 0; k < std::min(upper.size(), lower.size()); ++k) {
    if (upper[k].size() < 2) continue;
    path(canvas, upper[k]);
    for (auto p = lower[k].rbegin(); p != lower[k].rend(); ++p) canvas.line_to(p->x, p->y);
    canvas.close();
    canvas.fill();
  }
  canvas.see_through(false);
  if (!(curve.width > 0)) return;
  canvas.stroke_colour(curve.colour);
  canvas.line(curve.width, curve.dash);
  for (const auto* side : {&upper, &lower})
    for (const auto& part : *side)
      if (part.size() > 1) path(canvas, part), canvas.stroke();
  canvas.line(curve.width);
}

void draw_bars(Canvas& canvas, const Frame& frame, const Curve& curve) {
  canvas.stroke_colour(curve.colour);
  const double spacing = frame.w / static_cast<double>(std::max<std::size_t>(1, curve.x.size()));
  canvas.line(std::min(curve.width, std::max(0.1, 0.5 * spacing)));
  bool any = false;
  for (std::size_t i = 0; i < curve.x.size() && i < curve.y.size() && i < curve.y2.size(); ++i) {
    if (!drawable(curve.x[i]) || !drawable(curve.y[i]) || !drawable(curve.y2[i])) continue;
    canvas.move_to(frame.px(curve.x[i]), frame.py(curve.y[i]));
    canvas.line_to(frame.px(curve.x[i]), frame.py(curve.y2[i]));
    any = true;
  }
  if (any) canvas.stroke();
}

/// Of many points in one cell, the first is drawn, and the extremes of each column, so that a
/// million readings give a small file that looks the same.
std::vector<Point> scattered(const Frame& frame, const Curve& curve, double place) {
  const auto cells = [place](double length) {
    return static_cast<std::size_t>(std::max(0.0, length) / place) + 1;
  };
  const std::size_t columns = cells(frame.w), rows = cells(frame.h);
  std::vector<char> taken(columns * rows, 0);
  constexpr auto none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> low(columns, none), high(columns, none);
  std::vector<Point> all, out;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!drawable(curve.x[i]) || !drawable(curve.y[i])) continue;
    const Point p{frame.px(curve.x[i]), frame.py(curve.y[i])};
    const std::size_t c = std::min(cells(p.x - frame.x) - 1, columns - 1),
                      r = std::min(cells(p.y - frame.y) - 1, rows - 1);
    all.push_back(p);
    if (low[c] == none || p.y < all[low[c]].y) low[c] = all.size() - 1;
    if (high[c] == none || p.y > all[high[c]].y) high[c] = all.size() - 1;
    if (taken[c * rows + r] == 0) out.push_back(p);
    taken[c * rows + r] = 1;
  }
  for (std::size_t c = 0; c < columns; ++c)
    if (low[c] != none) out.push_back(all[low[c]]), out.push_back(all[high[c]]);
  return out;
}

void draw_items(Canvas& canvas, const Frame& frame, const Curve& curve) {
  const auto text_of = [](const std::vector<std::string>& all, std::size_t i) {
    return i < all.size() ? std::string_view(all[i]) : std::string_view();
  };
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!drawable(curve.x[i]) || !drawable(curve.y[i])) continue;
    canvas.begin_item(text_of(curve.titles, i), text_of(curve.links, i));
    draw_marker(canvas, curve.marker, frame.px(curve.x[i]), frame.py(curve.y[i]), curve.marker_size,
                curve.colour, 0.27 * curve.marker_size, curve.dash);
    canvas.end_item();
  }
}

void draw_points(Canvas& canvas, const Frame& frame, const Curve& curve) {
  if (!curve.titles.empty()) return draw_items(canvas, frame, curve);
  constexpr std::size_t many = 1000;
  if (curve.x.size() > many) {
    const double diameter = 0.8 * curve.marker_size;
    return canvas.dots(scattered(frame, curve, diameter), diameter, curve.colour);
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
    if (drawable(curve.x[i]) && drawable(curve.y[i]))
      points.push_back({frame.px(curve.x[i]), frame.py(curve.y[i])});
  draw_markers(canvas, curve.marker, points, curve.marker_size, curve.colour);
}

class PlotSetter {
 public:
  PlotSetter(const Plot& plot, double width, const Context& context, std::string_view field,
             Canvas& canvas)
      : canvas_(canvas),
        plot_(plot),
        width_(width),
        context_(context),
        style_(context.style),
        field_(field),
        size_(std::max(5.0, context.style.small - 0.5)) {}

  Expected<double> set() {
    const auto own_top = draw_top();
    if (!own_top || plot_.only_legend) return own_top;
    const double top = std::max(*own_top, plot_.top);
    // The drawing keeps a minimum height if title and legend have many lines.
    constexpr double least_drawn = 85, least_of_given = 45;
    const double below = room_below();
    const double height = std::max(plot_.height > 0 ? plot_.height : style_.plot_height,
                                   top + below + (plot_.height > 0 ? least_of_given : least_drawn));
    Range across, up;
    for (const Curve& curve : plot_.curves) {
      for (const double v : curve.x) across.add(v);
      for (const double v : curve.y) up.add(v);
      for (const double v : curve.y2) up.add(v);
    }
    const auto drawn = across.empty() || up.empty() ? draw_nothing(top, height)
                       : plot_.scales               ? draw(top, height, across, up)
                                                    : draw_picture(top, height, across, up);
    if (!drawn) return fail(drawn.error());
    return height;
  }

  const std::optional<Frame>& drawn() const { return drawn_; }

  Expected<double> draw_top() {
    if (plot_.only_legend) return draw_legend(0);
    const auto title = draw_title();
    return title ? draw_legend(*title) : title;
  }

 private:
  Expected<double> draw_title() {
    if (plot_.title.empty()) return 0.0;
    NONIO_TRY(auto title,
              set_text(context_, plot_.title, true, style_.small + 0.5, width_, field_));
    canvas_.fill_colour(style_.text);
    title.draw_all(canvas_, 0, 0);
    return title.height() + 1;
  }

  void draw_sample(const Curve& curve, double x, double y) {
    constexpr double length = 16;
    if (curve.kind == Curve::Kind::band) {
      canvas_.see_through(true);
      canvas_.filled(x, y - 2.5, length, 5, curve.colour);
      canvas_.see_through(false);
      canvas_.stroke_colour(curve.colour);
      canvas_.line(curve.width, curve.dash);
      if (curve.width > 0) {
        canvas_.segment(x, y + 2.5, x + length, y + 2.5);
        canvas_.segment(x, y - 2.5, x + length, y - 2.5);
      }
    } else {
      canvas_.stroke_colour(curve.colour);
      canvas_.line(std::max(curve.width, 0.1), curve.dash);
      if (curve.kind == Curve::Kind::bars)
        canvas_.segment(x + length / 2, y - 3, x + length / 2, y + 3);
      else if (curve.width > 0)
        canvas_.segment(x, y, x + length, y);
    }
    canvas_.line(curve.width);
    draw_marker(canvas_, curve.marker, x + length / 2, y, curve.marker_size, curve.colour);
  }

  Expected<double> draw_legend(double top) {
    double x = 0, y = top;
    bool any = false;
    for (const Curve& curve : plot_.curves) {
      if (curve.legend.empty()) continue;
      NONIO_TRY(auto text, set_text(context_, curve.legend, false, size_, width_ - 20, field_));
      double wide = 0;
      for (const TextLine& line : text.lines) wide = std::max(wide, 19 + line.width * size_);
      if (x > 0 && x + wide > width_) {
        x = 0;
        y += text.leading();
      }
      draw_sample(curve, x, -y - 0.65 * size_);
      canvas_.fill_colour(style_.text);
      text.draw_all(canvas_, x + 19, -y);
      y += text.height() - text.leading();
      x += wide + 9;
      any = true;
    }
    return any ? y + 1.3 * size_ + 3 : y;
  }

  Expected<void> draw_nothing(double top, double height) {
    NONIO_TRY(auto text, set_text(context_, plot_.empty_text, false, style_.small, width_, field_));
    canvas_.stroke_colour(style_.rule);
    canvas_.line(0.5);
    canvas_.rectangle(0, -height, width_, height - top);
    canvas_.stroke();
    canvas_.fill_colour(style_.muted);
    text.draw_all(canvas_, 0, -(height + top) / 2, width_, 0.5);
    return {};
  }

  Expected<void> draw(double top, double height, Range across, Range up) {
    if (plot_.zero_line) up.add(0.0);
    for (const Plot::Belt& belt : plot_.belts) up.add(belt.from), up.add(belt.to);
    for (const Plot::Limit& limit : plot_.limits) up.add(limit.at);
    for (const Plot::Span& span : plot_.spans) up.add(span.from), up.add(span.to);
    const double edge = (up.high - up.low) * 0.06, side = (across.high - across.low) * 0.025;
    Frame frame{};
    if (plot_.range)
      up.low = plot_.range->first, up.high = plot_.range->second;
    else
      up.low -= edge, up.high += edge;
    if (plot_.x_range)
      across.low = plot_.x_range->first, across.high = plot_.x_range->second;
    else
      across.low -= side, across.high += side;
    const double below = room_below();
    frame.h = height - top - below;
    if (plot_.same_scale) widen(up, (across.high - across.low) * frame.h / (width_ - 12 * size_));
    frame.up = axis_scale(up.low, up.high, 6, Ticks::decimal, plot_.language);
    std::vector<SetText> labels;
    double label_width = plot_.number_room;
    for (const std::string& label : frame.up.labels) {
      NONIO_TRY(auto text, set_line(context_, label, false, size_, width_, field_));
      label_width = std::max(label_width, text.lines[0].width * size_);
      labels.push_back(std::move(text));
    }
    NONIO_TRY(auto up_title, set_text(context_, plot_.y_title, false, size_, frame.h, field_));
    frame.x =
        1.3 * size_ * static_cast<double>(up_title.lines.size()) + 0.2 * size_ + label_width + 4;
    frame.y = -height + below;
    frame.w = width_ - frame.x - 2 - span_room() * static_cast<double>(plot_.spans.size());
    if (plot_.same_scale) widen(across, (up.high - up.low) * frame.w / frame.h);
    const auto ticks = plot_.degrees ? Ticks::turn : plot_.whole ? Ticks::whole : Ticks::decimal;
    frame.across =
        axis_scale(across.low, across.high, std::clamp(static_cast<int>(width_ / 30), 2, 7), ticks,
                   plot_.language);
    if (!plot_.lanes.empty()) frame.across = lanes();
    if (!plot_.ticks.empty()) frame.across = own_ticks(frame.across);
    if (auto ok = draw_axes(frame, labels, up_title); !ok) return ok;
    drawn_ = frame;
    canvas_.clip(frame.x, frame.y, frame.w, frame.h);
    canvas_.begin_part("drawn");
    canvas_.round_joins();
    if (auto ok = draw_events(frame); !ok) return ok;
    for (const auto& [at, colour] : plot_.limits) {
      canvas_.stroke_colour(colour);
      canvas_.line(1.2, Dash::dashed);
      canvas_.segment(frame.x, frame.py(at), frame.x + frame.w, frame.py(at));
    }
    for (const Curve& curve : plot_.curves) {
      if (curve.kind == Curve::Kind::band) draw_band(canvas_, frame, curve);
    }
    for (const Curve& curve : plot_.curves) {
      if (curve.kind == Curve::Kind::bars) draw_bars(canvas_, frame, curve);
      const bool titled = curve.kind == Curve::Kind::line && !curve.titles.empty();
      if (titled) canvas_.begin_item(curve.titles.front(), {});
      if (curve.kind == Curve::Kind::line) draw_line(canvas_, frame, curve);
      if (titled) canvas_.end_item();
      if (curve.kind == Curve::Kind::points) draw_points(canvas_, frame, curve);
    }
    canvas_.end_item();
    canvas_.leave();
    return draw_spans(frame);
  }

  Expected<void> draw_picture(double top, double height, Range across, Range up) {
    NONIO_TRY(auto caption, set_text(context_, plot_.x_title, false, size_, width_, field_));
    const double below = caption.height() + 2, edge = 1.6 * size_;
    Frame frame{
        edge, -height + below + edge, width_ - 2 * edge, height - top - below - 2 * edge, {}, {}};
    const double per_pt = std::max(
        {(across.high - across.low) / frame.w, (up.high - up.low) / std::max(frame.h, 1.0), 1e-9});
    widen(across, per_pt * frame.w);
    widen(up, per_pt * frame.h);
    frame.across.from = across.low, frame.across.to = across.high;
    frame.up.from = up.low, frame.up.to = up.high;
    canvas_.round_joins();
    for (const Curve& curve : plot_.curves) draw_line(canvas_, frame, curve);
    canvas_.fill_colour(style_.text);
    for (const Plot::Label& label : plot_.labels) {
      NONIO_TRY(auto text, set_line(context_, label.text, true, size_, width_, field_));
      const double x = frame.px(label.x), y = frame.py(label.y), half = size_ * 0.9;
      const double right = x - (frame.x + frame.w / 2), over = y - (frame.y + frame.h / 2);
      const double far = std::max(std::hypot(right, over), 1e-9);
      const double wide = text.lines[0].width * size_;
      text.draw(canvas_, 0, x + right / far * (half + wide / 2) - wide / 2,
                y + over / far * half + 0.65 * size_);
    }
    canvas_.fill_colour(style_.muted);
    caption.draw_all(canvas_, 0, -height + caption.height(), width_, 0.5);
    return {};
  }

  Expected<void> draw_axes(const Frame& f, const std::vector<SetText>& labels, const SetText& up) {
    for (const Plot::Belt& belt : plot_.belts)
      canvas_.filled(f.x, f.py(belt.from), f.w, f.py(belt.to) - f.py(belt.from), belt.colour);
    canvas_.stroke_colour(style_.rule);
    canvas_.line(style_.rule_width);
    for (const double tick : f.up.ticks) canvas_.segment(f.x, f.py(tick), f.x + f.w, f.py(tick));
    canvas_.begin_part("across");
    for (const double tick : f.across.ticks) {
      const double at = plot_.lanes.empty() ? tick : tick + 0.5;
      canvas_.segment(f.px(at), f.y, f.px(at), f.y + f.h);
    }
    canvas_.end_item();
    canvas_.stroke_colour(style_.muted);
    canvas_.line(0.5);
    if (plot_.zero_line) canvas_.segment(f.x, f.py(0), f.x + f.w, f.py(0));
    canvas_.rectangle(f.x, f.y, f.w, f.h);
    canvas_.stroke();
    canvas_.fill_colour(style_.text);
    for (std::size_t i = 0; i < labels.size(); ++i)
      labels[i].draw(canvas_, 0, 0, f.py(f.up.ticks[i]) + 0.65 * size_, f.x - 3, 1.0);
    if (auto ok = draw_axis_text(canvas_, context_, f.across, plot_.x_title, f.x, f.w, f.y - 2,
                                 size_, field_);
        !ok)
      return ok;
    for (std::size_t i = 0; i < up.lines.size(); ++i) {
      const TextLine& line = up.lines[i];
      canvas_.text_upwards(size_ * (1.0 + 1.3 * static_cast<double>(i)),
                           f.y + (f.h - line.width * size_) / 2, false, size_,
                           std::span(up.glyphs).subspan(line.begin, line.end - line.begin));
    }
    return {};
  }

  AxisScale own_ticks(AxisScale scale) const {
    scale.ticks.clear(), scale.labels.clear();
    for (const auto& [at, text] : plot_.ticks)
      if (at >= scale.from && at <= scale.to)
        scale.ticks.push_back(at), scale.labels.push_back(text);
    return scale;
  }

  Expected<void> draw_events(const Frame& f) {
    for (const Plot::Event& event : plot_.events) {
      if (!(event.at >= f.across.from && event.at <= f.across.to)) continue;
      NONIO_TRY(auto text, set_line(context_, event.text, false, size_, f.w, field_));
      const double x = f.px(event.at);
      canvas_.begin_item(event.title, {});
      canvas_.stroke_colour(style_.muted);
      canvas_.line(0.8, Dash::dotted);
      canvas_.segment(x, f.y, x, f.y + f.h);
      canvas_.fill_colour(style_.muted);
      text.draw(canvas_, 0, x + 3, f.y + f.h);
      canvas_.end_item();
    }
    return {};
  }

  AxisScale lanes() const {
    AxisScale scale{0.0, static_cast<double>(plot_.lanes.size()), {}, plot_.lanes};
    for (std::size_t k = 0; k < plot_.lanes.size(); ++k)
      scale.ticks.push_back(static_cast<double>(k) + 0.5);
    return scale;
  }

  static void widen(Range& range, double span) {
    const double more = std::max(0.0, span - (range.high - range.low)) / 2;
    range.low -= more, range.high += more;
  }

  /// Height for numbers and title of the horizontal axis; custom ticks without title need less.
  double room_below() const {
    return (plot_.x_title.empty() && !plot_.ticks.empty() ? 1.6 : 2.9) * size_ + 3;
  }

  double span_room() const { return 1.3 * size_ + 7; }

  Expected<void> draw_spans(const Frame& f) {
    double x = f.x + f.w + 5;
    for (const Plot::Span& span : plot_.spans) {
      NONIO_TRY(auto text, set_line(context_, span.text, false, size_, f.h, field_));
      const double low = f.py(std::min(span.from, span.to)),
                   high = f.py(std::max(span.from, span.to));
      canvas_.stroke_colour(style_.text);
      canvas_.line(0.5);
      canvas_.segment(x, low, x, high);
      canvas_.segment(x - 2.5, low, x + 2.5, low);
      canvas_.segment(x - 2.5, high, x + 2.5, high);
      canvas_.fill_colour(style_.text);
      const double wide = text.lines[0].width * size_;
      const double from = std::clamp((low + high - wide) / 2, f.y, std::max(f.y, f.y + f.h - wide));
      canvas_.text_upwards(x + size_ + 2, from, false, size_, text.glyphs);
      x += span_room();
    }
    return {};
  }

  Canvas& canvas_;
  const Plot& plot_;
  double width_;
  const Context& context_;
  const Style& style_;
  std::string_view field_;
  double size_;
  std::optional<Frame> drawn_{};
};

}  // namespace

Expected<Laid> lay_plot(const Plot& plot, double width, const Context& context,
                        std::string_view field) {
  PdfCanvas canvas;
  NONIO_TRY(const auto height, PlotSetter(plot, width, context, field, canvas).set());
  const bool legend = plot.only_legend;
  return Laid{{{height, legend ? 2.0 : 5.0, std::move(canvas.ops), legend}}};
}

Expected<double> plot_top(const Plot& plot, double width, const Context& context,
                          std::string_view field) {
  PdfCanvas canvas;
  return PlotSetter(plot, width, context, field, canvas).draw_top();
}

Drawing drawing_of(const Plot& plot, double width, const Style& style, const Fonts& fonts,
                   std::span<const NamedColour> colours) {
  Used none;
  const Context context{style, fonts, style.page_height, none, Medium::screen};
  SvgCanvas canvas(colours, style.see_through);
  PlotSetter setter(plot, width, context, "", canvas);
  const auto height = setter.set();
  Drawing out{height.value(), std::move(canvas.elements), canvas.has_links, {}};
  if (const auto& f = setter.drawn())
    out.frame = {f->x,           -f->y - f->h, f->w,       f->h,
                 f->across.from, f->across.to, f->up.from, f->up.to};
  return out;
}

}  // namespace nonio::reports
