// SPDX-License-Identifier: Apache-2.0
#include "chart.h"

#include <algorithm>
#include <cmath>

#include "axis_scale.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::reports::site {

namespace {

constexpr double width = 720.0, height = 260.0, left = 58.0, right = 12.0, top = 22.0,
                 bottom = 40.0;

std::string coordinate(double v) { return fixed_text(v, 1); }

std::string attribute(const char* name, double v) {
  return ' ' + std::string(name) + "=\"" + coordinate(v) + '"';
}

double days(Day day) { return static_cast<double>(day.time_since_epoch().count()); }

/// A range that grows with what it is shown.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void show(double v) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  bool empty() const { return !(low <= high); }
  void widen(double part, double least) {
    const double by = std::max(part * (high - low), least);
    low -= by, high += by;
  }
};

/// Places of numbers on the picture.
struct Frame {
  AxisScale x, y;
  double at_x(double v) const { return left + x.at(v) * (width - left - right); }
  double at_y(double v) const { return height - bottom - y.at(v) * (height - top - bottom); }
};

std::string text_at(double x, double y, std::string_view text, const char* anchor,
                    const char* style = nullptr) {
  return "<text" + attribute("x", x) + attribute("y", y) + " text-anchor=\"" + anchor + '"' +
         (style != nullptr ? " class=\"" + std::string(style) + '"' : "") + '>' + html(text) +
         "</text>";
}

std::string line_of(double x1, double y1, double x2, double y2, const char* style) {
  return "<line class=\"" + std::string(style) + '"' + attribute("x1", x1) + attribute("y1", y1) +
         attribute("x2", x2) + attribute("y2", y2) + "/>";
}

std::string rules(const Frame& f, const std::string& unit) {
  std::string out;
  for (std::size_t i = 0; i < f.y.ticks.size(); ++i) {
    const double y = f.at_y(f.y.ticks[i]);
    out +=
        line_of(left, y, width - right, y, "rule") + text_at(left - 6, y + 4, f.y.labels[i], "end");
  }
  for (std::size_t i = 0; i < f.x.ticks.size(); ++i) {
    const double x = f.at_x(f.x.ticks[i]);
    out += line_of(x, top, x, height - bottom, "rule") +
           text_at(x, height - bottom + 16, f.x.labels[i], "middle");
  }
  return out + text_at(4, top - 10, unit, "start");
}

/// One thing to those who do not see it, but with links in it a group, so that they reach them.
std::string picture(const std::string& label, const std::string& inside) {
  const std::string role = inside.find("<a ") == std::string::npos ? "img" : "group";
  return "<svg class=\"chart\" role=\"" + role + "\" viewBox=\"0 0 " + fixed_text(width, 0) + ' ' +
         fixed_text(height, 0) + "\" aria-label=\"" + html(label) + "\">" + inside + "</svg>\n";
}

/// Years where there are many, else quarters.
AxisScale calendar(const Page& page, double low, double high) {
  AxisScale out;
  out.from = low, out.to = high;
  using namespace std::chrono;
  const double span = high - low;
  const unsigned step = span > 365 * 3 ? 12 : span > 500 ? 6 : span > 200 ? 3 : 1;
  const year_month_day first{Day(std::chrono::days(static_cast<int>(std::floor(low))))};
  for (year_month at = first.year() / January; days(Day(at / 1)) <= high; at += months(step)) {
    const double tick = days(Day(at / 1));
    if (tick < low) continue;
    out.ticks.push_back(tick);
    const std::string y = std::to_string(static_cast<int>(at.year()));
    const auto m = static_cast<unsigned>(at.month());
    out.labels.push_back(
        step == 12 ? y : month_text(page, y + (m < 10 ? "-0" : "-") + std::to_string(m)));
  }
  return out;
}

double scaled(double v, Quantity q) { return v * unit_of(q).per_si; }

/// One series in printed units against days.
class HistoryDrawing {
 public:
  HistoryDrawing(const Page& page, const MachineHistory& machine, const HistorySeries& series)
      : page_(page), machine_(machine), series_(series) {}

  std::string svg() {
    fit();
    if (x_.empty()) return {};
    const std::string label =
        machine_.id + ' ' + series_.axis + ' ' + quantity_text(page_, series_.quantity);
    return picture(label, guard() + rules(frame_, unit_text(series_.unit)) + events() + model() +
                              forecast() + points());
  }

  /// Without rules and words.
  std::string spark() {
    fit();
    if (x_.empty()) return {};
    std::string path;
    for (const HistoryPoint& p : series_.points)
      if (const auto day = day_of(p.date); day && p.joined)
        path += (path.empty() ? "M" : "L") + coordinate(2 + frame_.x.at(days(*day)) * 116) + ' ' +
                coordinate(22 - frame_.y.at(value(p.value)) * 20);
    if (path.empty()) return {};
    std::string out = "<path class=\"line\" d=\"" + path + "\"/>";
    if (shows_limit_)
      for (const double side : sides()) {
        const double y = 22 - frame_.y.at(side * value(*series_.limit)) * 20;
        if (y >= 0 && y <= 24) out += line_of(0, y, 120, y, "limit");
      }
    return "<svg class=\"spark\" viewBox=\"0 0 120 24\" aria-hidden=\"true\">" + out + "</svg>";
  }

 private:
  double value(double si) const { return scaled(si, series_.unit); }

  /// What is followed has a sign and a limit on both sides; the largest deviations are none below 0.
  std::vector<double> sides() const {
    return series_.model.empty() ? std::vector<double>{1.0} : std::vector<double>{1.0, -1.0};
  }

  void fit() {
    for (const HistoryPoint& p : series_.points) {
      const auto day = day_of(p.date);
      if (!day) continue;
      x_.show(days(*day));
      y_.show(value(p.value + 2 * p.u)), y_.show(value(p.value - 2 * p.u));
    }
    if (series_.forecast) {
      const HistoryForecast& f = *series_.forecast;
      if (const auto day = day_of(f.date)) x_.show(days(*day));
      y_.show(value(f.value + 2 * f.u)), y_.show(value(f.value - 2 * f.u));
    }
    if (x_.empty()) return;
    if (series_.limit) {
      // A limit far away would press the readings flat.
      const double limit = value(*series_.limit),
                   most = std::max(std::fabs(y_.low), std::fabs(y_.high));
      shows_limit_ = limit <= 3 * most || most == 0.0;
      if (shows_limit_) {
        if (y_.high > 0) y_.show(limit);
        if (y_.low < 0 && sides().size() > 1) y_.show(-limit);
      }
    }
    x_.widen(0.03, 20);
    y_.widen(0.08, 1e-9 + 1e-3 * std::max(std::fabs(y_.low), std::fabs(y_.high)));
    frame_.x = calendar(page_, x_.low, x_.high);
    frame_.y = axis_scale(y_.low, y_.high, 5, Ticks::decimal, page_.words.language());
  }

  double at(std::string_view date) const {
    const auto day = day_of(date);
    return frame_.at_x(day ? days(*day) : x_.low);
  }
  double at_value(double si) const { return frame_.at_y(value(si)); }

  /// Between the limit and what U leaves of it.
  std::string guard() const {
    if (!shows_limit_ || series_.points.empty()) return {};
    std::string out;
    const double U = 2 * series_.points.back().u;
    for (const double side : sides()) {
      const double limit = side * *series_.limit, kept = limit - side * U;
      if (value(limit) > frame_.y.to || value(limit) < frame_.y.from) continue;
      const double a = at_value(limit), b = std::clamp(at_value(kept), top, height - bottom);
      out += "<rect class=\"guard\"" + attribute("x", left) + attribute("y", std::min(a, b)) +
             attribute("width", width - left - right) + attribute("height", std::fabs(a - b)) +
             "/>" + line_of(left, a, width - right, a, "limit");
    }
    return out;
  }

  std::string events() const {
    std::string out;
    std::size_t number = 0;
    for (const MachineEvent& e : machine_.events) {
      ++number;
      const auto day = day_of(e.date);
      if (!day || (!e.axis.empty() && e.axis != series_.axis)) continue;
      const double x = frame_.at_x(days(*day));
      if (x < left || x > width - right) continue;
      out += "<g>" + element("title", html(e.date + ' ' + e.text)) +
             line_of(x, top, x, height - bottom, "event") +
             text_at(x + 3, top + 9, std::to_string(number), "start", "event-number") + "</g>";
    }
    return out;
  }

  std::string band(double x1, double y1, double u1, double x2, double y2, double u2,
                   const char* style) const {
    return "<polygon class=\"" + std::string(style) + "\" points=\"" + coordinate(x1) + ',' +
           coordinate(at_value(y1 + 2 * u1)) + ' ' + coordinate(x2) + ',' +
           coordinate(at_value(y2 + 2 * u2)) + ' ' + coordinate(x2) + ',' +
           coordinate(at_value(y2 - 2 * u2)) + ' ' + coordinate(x1) + ',' +
           coordinate(at_value(y1 - 2 * u1)) + "\"/>";
  }

  std::string model() const {
    std::string out;
    for (const HistorySegment& s : series_.segments) {
      const double a = at(s.from), b = at(s.to);
      out += band(a, s.first, s.u_first, b, s.last, s.u_last, "band") +
             line_of(a, at_value(s.first), b, at_value(s.last), "line");
    }
    return out;
  }

  std::string forecast() const {
    if (!series_.forecast || series_.segments.empty() || !std::isfinite(series_.forecast->value))
      return {};
    const HistorySegment& s = series_.segments.back();
    const HistoryForecast& f = *series_.forecast;
    const double a = at(s.to), b = at(f.date);
    return band(a, s.last, s.u_last, b, f.value, f.u, "cone") +
           line_of(a, at_value(s.last), b, at_value(f.value), "line dashed");
  }

  std::string points() const {
    std::string out;
    for (const HistoryPoint& p : series_.points) {
      if (!day_of(p.date)) continue;
      const double x = at(p.date), y = at_value(p.value);
      std::string inside =
          element("title",
                  html(p.date + ' ' + p.campaign + ": " +
                       value_text(page_, p.value, u_of_value(p), series_.unit) +
                       (p.joined
                            ? ""
                            : " (" + page_.words.get_or("site.not_joined." + p.why_not, p.why_not) +
                                  ")"))) +
          line_of(x, at_value(p.value - 2 * p.u), x, at_value(p.value + 2 * p.u), "bar");
      const char* style = !p.joined                                 ? "point apart"
                          : p.state == HistoryPoint::State::as_left ? "point left"
                                                                    : "point";
      if (p.state == HistoryPoint::State::check)
        inside += "<rect class=\"" + std::string(style) + '"' + attribute("x", x - 4) +
                  attribute("y", y - 4) + " width=\"8\" height=\"8\"/>";
      else
        inside += "<circle class=\"" + std::string(style) + '"' + attribute("cx", x) +
                  attribute("cy", y) + " r=\"4.5\"/>";
      out += p.link.empty() ? element("g", inside) : link(page_.to_root + p.link, inside);
    }
    return out;
  }

  const Page& page_;
  const MachineHistory& machine_;
  const HistorySeries& series_;
  Range x_{}, y_{};
  Frame frame_{};
  bool shows_limit_ = false;
};

std::string polyline(const Frame& f, const std::vector<double>& x, const std::vector<double>& y,
                     const std::string& style) {
  std::string points;
  for (std::size_t i = 0; i < x.size(); ++i)
    points += (i == 0 ? "" : " ") + coordinate(f.at_x(x[i])) + ',' + coordinate(f.at_y(y[i]));
  return "<polyline class=\"" + style + "\" points=\"" + points + "\"/>";
}

/// The curves of an axis in printed units.
struct Curves {
  std::vector<const ErrorCurve*> all;
  Quantity position = Quantity::length, deviation = Quantity::deviation;
};

Curves curves_of(const MachineHistory& machine, const std::string& axis) {
  Curves out;
  for (const ErrorCurve& c : machine.curves)
    if (c.axis == axis && c.position.size() == c.mean.size() && c.position.size() > 1)
      out.all.push_back(&c);
  if (!out.all.empty() && out.all.front()->rotary)
    out.position = Quantity::angle, out.deviation = Quantity::angular_deviation;
  return out;
}

std::vector<double> in_units(const std::vector<double>& si, Quantity q) {
  std::vector<double> out;
  for (const double v : si) out.push_back(scaled(v, q));
  return out;
}

Frame frame_of(const Page& page, Range x, Range y, bool turn) {
  x.widen(0.02, 1e-9), y.widen(0.08, 1e-6);
  return {axis_scale(x.low, x.high, 8, turn ? Ticks::turn : Ticks::decimal, page.words.language()),
          axis_scale(y.low, y.high, 5, Ticks::decimal, page.words.language())};
}

}  // namespace

std::string history_chart(const Page& page, const MachineHistory& machine,
                          const HistorySeries& series) {
  return HistoryDrawing(page, machine, series).svg();
}

std::string spark_line(const Page& page, const HistorySeries& series) {
  static const MachineHistory none{};
  return HistoryDrawing(page, none, series).spark();
}

std::string curves_chart(const Page& page, const MachineHistory& machine, const std::string& axis) {
  const Curves curves = curves_of(machine, axis);
  if (curves.all.empty()) return {};
  Range x, y;
  for (const ErrorCurve* c : curves.all) {
    for (const double p : c->position) x.show(scaled(p, curves.position));
    for (const double m : c->mean) y.show(scaled(m, curves.deviation));
  }
  const Frame f = frame_of(page, x, y, curves.all.front()->rotary);
  std::string drawn = rules(f, unit_text(curves.deviation));
  for (const ErrorCurve* c : curves.all)
    drawn +=
        "<g>" + element("title", html(c->date + ' ' + c->campaign)) +
        polyline(f, in_units(c->position, curves.position), in_units(c->mean, curves.deviation),
                 c == curves.all.back() ? "line today" : "line earlier") +
        "</g>";
  drawn += text_at(width - right, height - 4, axis + ", " + unit_text(curves.position), "end");
  return picture(page.words.get("site.curves", {{"axis", axis}}), drawn);
}

std::string difference_chart(const Page& page, const MachineHistory& machine,
                             const std::string& axis) {
  const Curves curves = curves_of(machine, axis);
  if (curves.all.size() < 2) return {};
  const ErrorCurve &last = *curves.all.back(), &before = *curves.all[curves.all.size() - 2];
  if (last.position != before.position) return {};
  std::vector<double> difference;
  for (std::size_t i = 0; i < last.mean.size(); ++i)
    difference.push_back(scaled(last.mean[i] - before.mean[i], curves.deviation));
  const double U = 2 * scaled(std::hypot(last.u, before.u), curves.deviation);
  Range x, y;
  for (const double p : last.position) x.show(scaled(p, curves.position));
  for (const double d : difference) y.show(d + U), y.show(d - U);
  y.show(0.0);
  const Frame f = frame_of(page, x, y, last.rotary);
  std::vector<double> xs = in_units(last.position, curves.position);
  std::string band;
  for (std::size_t i = 0; i < xs.size(); ++i)
    band += coordinate(f.at_x(xs[i])) + ',' + coordinate(f.at_y(difference[i] + U)) + ' ';
  for (std::size_t i = xs.size(); i-- > 0;)
    band += coordinate(f.at_x(xs[i])) + ',' + coordinate(f.at_y(difference[i] - U)) + ' ';
  band.pop_back();
  return picture(
      page.words.get("site.difference", {{"axis", axis}}),
      rules(f, unit_text(curves.deviation)) +
          line_of(left, f.at_y(0), width - right, f.at_y(0), "zero") +
          "<polygon class=\"band\" points=\"" + band + "\"/>" +
          polyline(f, xs, difference, "line today") +
          text_at(width - right, height - 4, axis + ", " + unit_text(curves.position), "end"));
}

std::string comparison_chart(const Page& page, const ModelComparison& comparison) {
  Range y;
  for (const auto& m : comparison.machines)
    y.show(scaled(m.value + 2 * m.u, comparison.unit)),
        y.show(scaled(m.value - 2 * m.u, comparison.unit));
  if (y.empty()) return {};
  y.widen(0.08, 1e-6);
  Frame f;
  f.y = axis_scale(y.low, y.high, 5, Ticks::decimal, page.words.language());
  f.x.from = -0.7, f.x.to = static_cast<double>(comparison.machines.size()) - 0.3;
  std::string points;
  const std::size_t each = (comparison.machines.size() + 9) / 10;  // names that have room
  for (std::size_t i = 0; i < comparison.machines.size(); ++i) {
    const auto& m = comparison.machines[i];
    if (i % each == 0) f.x.ticks.push_back(static_cast<double>(i)), f.x.labels.push_back(m.machine);
    const double x = f.at_x(static_cast<double>(i));
    const auto at = [&](double v) { return f.at_y(scaled(v, comparison.unit)); };
    points += line_of(x, at(m.value - 2 * m.u), x, at(m.value + 2 * m.u), "bar") +
              "<circle class=\"" + (std::fabs(m.z) > 3 ? "point out" : "point") + '"' +
              attribute("cx", x) + attribute("cy", at(m.value)) + " r=\"4.5\"/>";
  }
  return picture(comparison.model + ' ' + comparison.axis,
                 rules(f, unit_text(comparison.unit)) + points);
}

}  // namespace nonio::reports::site
