// SPDX-License-Identifier: Apache-2.0
#include "chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/reports/drawing.h"
#include "nonio/reports/number.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/format.h"

namespace nonio::reports::site {

namespace {

using Curve = Plot::Curve;

/// Colors of site.css, which replaces their values in dark mode.
constexpr Colour hex(unsigned rgb) {
  const auto part = [rgb](unsigned shift) {
    return static_cast<float>((rgb >> shift) & 255U) / 255.0F;
  };
  return {part(16), part(8), part(0)};
}
namespace ink {
constexpr Colour text = hex(0x1a1a1a), muted = hex(0x5c6470), rule = hex(0xd3d7dc),
                 accent = hex(0x12395b), measured = hex(0x0a5fa5), failed = hex(0xa61b1b),
                 back = hex(0xffffff), band = hex(0xb9cfe3), guard = hex(0xf0dcc4),
                 cone = hex(0xd5e1ed), earlier = hex(0xb4b9bf);
}  // namespace ink
constexpr std::array<NamedColour, 11> named{{{ink::text, "text"},
                                             {ink::muted, "muted"},
                                             {ink::rule, "rule"},
                                             {ink::accent, "accent"},
                                             {ink::measured, "line"},
                                             {ink::failed, "failed"},
                                             {ink::back, "back"},
                                             {ink::band, "band"},
                                             {ink::guard, "guard"},
                                             {ink::cone, "cone"},
                                             {ink::earlier, "earlier"}}};

constexpr double width = 720.0;

Style style() {
  Style out;
  out.small = 15.5;  // because axis labels are 0.5 px smaller
  out.plot_height = 260.0;
  out.see_through = 0.6;
  out.rule_width = 0.5;
  out.text = ink::text, out.muted = ink::muted, out.rule = ink::rule;
  return out;
}

/// For screen readers, a chart is one image or, if it has links, a group, so that these are
/// accessible.
///
/// `across`: what the horizontal axis has: days, names, turn (degrees) or "".
Html picture(const Page& page, const std::string& label, const Plot& plot, const char* across) {
  const Drawing drawn = drawing_of(plot, width, style(), *page.fonts, named);
  std::string frame;
  for (const double v : drawn.frame)
    append_shortest(frame.empty() ? frame : frame += ' ', std::round(v * 1e6) / 1e6);
  const auto attribute = [](const char* name, const std::string& value) {
    return std::string(" ") + name + "=\"" + html_of(value).text + "\"";
  };
  return {"<svg class=\"chart\"" + attribute("role", drawn.has_links ? "group" : "img") +
          attribute("viewBox", "0 0 " + fixed_text(width, 0) + ' ' + fixed_text(drawn.height, 0)) +
          attribute("aria-label", label) + (frame.empty() ? "" : attribute("data-frame", frame)) +
          attribute("data-across", across) + attribute("data-x", plot.x_title) +
          attribute("data-y", plot.y_title) + ">" + drawn.elements + "</svg>\n"};
}

double days(Day day) { return static_cast<double>(day.time_since_epoch().count()); }

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
  std::pair<double, double> ends() const { return {low, high}; }
};

std::vector<std::pair<double, std::string>> calendar(const Page& page, const Range& range) {
  using namespace std::chrono;
  std::vector<std::pair<double, std::string>> out;
  const double span = range.high - range.low;
  const unsigned step = span > 365 * 3 ? 12 : span > 500 ? 6 : span > 200 ? 3 : 1;
  const year_month_day first{Day(std::chrono::days(static_cast<int>(std::floor(range.low))))};
  for (year_month at = first.year() / January; days(Day(at / 1)) <= range.high;
       at += months(step)) {
    const std::string y = std::to_string(static_cast<int>(at.year()));
    const auto m = static_cast<unsigned>(at.month());
    out.emplace_back(
        days(Day(at / 1)),
        step == 12 ? y : month_text(page, y + (m < 10 ? "-0" : "-") + std::to_string(m)));
  }
  return out;
}

double scaled(double v, Quantity q) { return v * unit_of(q).per_si; }

class HistoryPlot {
 public:
  HistoryPlot(const Page& page, const MachineHistory& machine, const HistorySeries& series)
      : page_(page),
        machine_(machine),
        series_(series),
        numbers_(series, machine.series, page.words) {
    fit();
  }

  Html svg() {
    if (x_.empty()) return {};
    plot_.y_title = unit_text(numbers_.quantity());
    plot_.language = page_.words.language();
    plot_.zero_line = false;
    plot_.x_range = x_.ends(), plot_.range = y_.ends();
    plot_.ticks = calendar(page_, x_);
    add_limits();
    add_events();
    for (const HistorySegment& s : series_.segments)
      add_model({s.from, s.first, s.u_first}, {s.to, s.last, s.u_last}, Dash::solid, ink::band);
    if (series_.forecast && !series_.segments.empty() && std::isfinite(series_.forecast->value)) {
      const HistorySegment& s = series_.segments.back();
      const HistoryForecast& f = *series_.forecast;
      add_model({s.to, s.last, s.u_last}, {f.date, f.value, f.u}, Dash::dashed, ink::cone);
    }
    add_points();
    return picture(page_,
                   machine_.id + ' ' + series_.axis + ' ' + quantity_text(page_, series_.quantity),
                   plot_, "days");
  }

  Html spark() const {
    if (x_.empty()) return {};
    const auto y = [this](double v) {
      return fixed_text(22 - 20 * (v - y_.low) / (y_.high - y_.low), 1);
    };
    std::string path;
    for (const HistoryPoint& p : series_.points)
      if (const auto day = day_of(p.date); day && p.joined && std::isfinite(p.value))
        path += (path.empty() ? "M" : "L") +
                fixed_text(2 + 116 * (days(*day) - x_.low) / (x_.high - x_.low), 1) + ' ' +
                y(value(p.value));
    if (path.empty()) return {};
    if (path.find('L') == std::string::npos) path += "h3";  // a single value is a dash
    std::string out = "<path class=\"line\" d=\"" + path + "\"/>";
    for (const double limit : limits_) {
      const std::string at = y(limit);
      out += "<line class=\"limit\" x1=\"0\" y1=\"" + at + "\" x2=\"120\" y2=\"" + at + "\"/>";
    }
    return {"<svg class=\"spark\" viewBox=\"0 0 120 24\" aria-hidden=\"true\">" + out + "</svg>"};
  }

 private:
  struct At {
    std::string date;
    double value, u;
  };

  double value(double followed) const { return numbers_.in_unit(followed); }
  double x_of(std::string_view date) const {
    const auto day = day_of(date);
    return day ? days(*day) : x_.low;
  }

  void fit() {
    const auto show = [this](const std::string& date, double v, double u) {
      const auto day = day_of(date);
      if (!day) return;
      x_.show(days(*day));
      y_.show(value(v + 2 * u)), y_.show(value(v - 2 * u));
    };
    for (const HistoryPoint& p : series_.points) show(p.date, p.value, p.u);
    if (x_.empty()) return;
    if (const auto& f = series_.forecast) show(f->date, f->value, f->u);
    const double most = std::max(std::fabs(y_.low), std::fabs(y_.high));
    // A distant limit would flatten the readings.
    if (const auto& limit = series_.limit; limit && (value(*limit) <= 3 * most || most == 0.0)) {
      if (y_.high > 0) y_.show(value(*limit));
      // Followed quantities are signed and have limits on both sides; largest deviations are not.
      if (y_.low < 0 && !series_.model.empty()) y_.show(-value(*limit));
      for (const double side : {1.0, -1.0})
        if (side > 0 || !series_.model.empty()) limits_.push_back(side * value(*limit));
    }
    if (y_.empty()) y_.show(0.0);
    x_.widen(0.03, 20);
    y_.widen(0.08, 1e-9 + 1e-6 * most);
    std::erase_if(limits_, [this](double limit) { return limit < y_.low || limit > y_.high; });
  }

  void add_limits() {
    const double U = value(2 * series_.points.back().u);
    for (const double limit : limits_) {
      plot_.limits.push_back({limit, ink::failed});
      const double kept = std::clamp(limit - std::copysign(U, limit), y_.low, y_.high);
      plot_.belts.push_back({std::min(limit, kept), std::max(limit, kept), ink::guard});
    }
  }

  void add_events() {
    for (std::size_t i = 0; i < machine_.events.size(); ++i) {
      const MachineEvent& e = machine_.events[i];
      if (const auto day = day_of(e.date); day && (e.axis.empty() || e.axis == series_.axis))
        plot_.events.push_back({days(*day), std::to_string(i + 1), e.date + ' ' + e.text});
    }
  }

  void add_model(const At& a, const At& b, Dash dash, Colour shade) {
    Curve area{.kind = Curve::Kind::band, .x = {}, .y = {}, .colour = shade, .width = 0};
    Curve line{.x = {}, .y = {}, .colour = ink::measured, .width = 1.7, .dash = dash};
    // A line of logarithms is a curve of the scatter.
    const int steps = numbers_.is_scatter() ? 16 : 1;
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double x = std::lerp(x_of(a.date), x_of(b.date), t), y = std::lerp(a.value, b.value, t),
                   u = std::lerp(a.u, b.u, t);
      area.x.push_back(x), line.x.push_back(x);
      line.y.push_back(value(y));
      area.y.push_back(value(y + 2 * u)), area.y2.push_back(value(y - 2 * u));
    }
    plot_.curves.push_back(std::move(area));
    plot_.curves.push_back(std::move(line));
  }

  Curve marks_of(const HistoryPoint& p) const {
    const bool check = p.state == HistoryPoint::State::check;
    const bool filled = p.joined && p.state != HistoryPoint::State::as_left;
    Curve out{.kind = Curve::Kind::points,
              .x = {},
              .y = {},
              .colour = p.joined ? ink::accent : ink::muted};
    out.dash = p.joined ? Dash::solid : Dash::dotted;
    out.marker = check ? Marker::square : filled ? Marker::dot : Marker::ring;
    out.marker_size = 5.5;
    return out;
  }

  std::string title_of(const HistoryPoint& p) const {
    std::string out = p.date + ' ' + p.campaign + ": " + numbers_.value(p.value, u_of_value(p));
    if (!p.joined)
      out += " (" + page_.words.get_or("site.not_joined." + p.why_not, p.why_not) + ")";
    return out;
  }

  /// In date order, which is also the tab order.
  void add_points() {
    Curve bars{.kind = Curve::Kind::bars, .x = {}, .y = {}, .colour = ink::accent, .width = 1.2};
    std::vector<Curve> marks;
    for (const HistoryPoint& p : series_.points) {
      if (!day_of(p.date)) continue;
      bars.x.push_back(x_of(p.date));
      bars.y.push_back(value(p.value - 2 * p.u)), bars.y2.push_back(value(p.value + 2 * p.u));
      Curve mark = marks_of(p);
      if (marks.empty() || marks.back().marker != mark.marker || marks.back().dash != mark.dash)
        marks.push_back(std::move(mark));
      marks.back().x.push_back(x_of(p.date));
      marks.back().y.push_back(value(p.value));
      marks.back().titles.push_back(title_of(p));
      marks.back().links.push_back(p.link.empty() ? "" : page_.to_root + p.link);
    }
    plot_.curves.push_back(std::move(bars));
    for (Curve& curve : marks) plot_.curves.push_back(std::move(curve));
  }

  const Page& page_;
  const MachineHistory& machine_;
  const HistorySeries& series_;
  FollowedNumbers numbers_;
  Range x_{}, y_{};
  std::vector<double> limits_;
  Plot plot_;
};

std::vector<double> in_units(const std::vector<double>& si, Quantity q) {
  std::vector<double> out;
  for (const double v : si) out.push_back(scaled(v, q));
  return out;
}

struct Curves {
  std::vector<const ErrorCurve*> all;
  Quantity position = Quantity::length, deviation = Quantity::deviation;
  Plot plot;
};

Curves curves_of(const Page& page, const MachineHistory& machine, const std::string& axis) {
  Curves out;
  for (const ErrorCurve& c : machine.curves)
    if (c.axis == axis && c.position.size() == c.mean.size() && c.position.size() > 1)
      out.all.push_back(&c);
  if (out.all.empty()) return out;
  out.plot.degrees = out.all.front()->rotary;
  if (out.plot.degrees) out.position = Quantity::angle, out.deviation = Quantity::angular_deviation;
  out.plot.language = page.words.language();
  out.plot.x_title = axis + ", " + unit_text(out.position);
  out.plot.y_title = unit_text(out.deviation);
  out.plot.zero_line = false;
  return out;
}

}  // namespace

Html history_chart(const Page& page, const MachineHistory& machine, const HistorySeries& series) {
  return HistoryPlot(page, machine, series).svg();
}

Html spark_line(const Page& page, const HistorySeries& series) {
  static const MachineHistory none{};
  return HistoryPlot(page, none, series).spark();
}

Html curves_chart(const Page& page, const MachineHistory& machine, const std::string& axis) {
  Curves curves = curves_of(page, machine, axis);
  if (curves.all.empty()) return {};
  for (const ErrorCurve* c : curves.all) {
    const bool last = c == curves.all.back();
    Curve curve{.x = in_units(c->position, curves.position),
                .y = in_units(c->mean, curves.deviation),
                .colour = last ? ink::measured : ink::earlier,
                .width = last ? 2.2 : 1.0};
    curve.titles = {c->date + ' ' + c->campaign};
    curves.plot.curves.push_back(std::move(curve));
  }
  return picture(page, page.words.get("site.curves", {{"axis", axis}}), curves.plot,
                 curves.plot.degrees ? "turn" : "");
}

Html difference_chart(const Page& page, const MachineHistory& machine, const std::string& axis) {
  Curves curves = curves_of(page, machine, axis);
  if (curves.all.size() < 2) return {};
  const ErrorCurve &last = *curves.all.back(), &before = *curves.all[curves.all.size() - 2];
  if (last.position != before.position) return {};
  const double U = 2 * scaled(std::hypot(last.u, before.u), curves.deviation);
  Curve line{.x = in_units(last.position, curves.position),
             .y = {},
             .colour = ink::measured,
             .width = 2.2};
  Curve area{.kind = Curve::Kind::band, .x = line.x, .y = {}, .colour = ink::band, .width = 0};
  for (std::size_t i = 0; i < last.mean.size(); ++i) {
    line.y.push_back(scaled(last.mean[i] - before.mean[i], curves.deviation));
    area.y.push_back(line.y.back() + U), area.y2.push_back(line.y.back() - U);
  }
  curves.plot.zero_line = true;
  curves.plot.curves = {std::move(area), std::move(line)};
  return picture(page, page.words.get("site.difference", {{"axis", axis}}), curves.plot,
                 curves.plot.degrees ? "turn" : "");
}

Html comparison_chart(const Page& page, const ModelComparison& comparison) {
  const FollowedNumbers numbers = numbers_of(page, comparison);
  Plot plot;
  plot.language = page.words.language();
  plot.y_title = unit_text(numbers.quantity());
  plot.zero_line = false;
  plot.x_range = {-0.7, static_cast<double>(comparison.machines.size()) - 0.3};
  Curve bars{.kind = Curve::Kind::bars, .x = {}, .y = {}, .colour = ink::accent, .width = 1.2};
  Curve inside{.kind = Curve::Kind::points, .x = {}, .y = {}, .colour = ink::accent};
  inside.marker = Marker::dot, inside.marker_size = 5.5;
  Curve far = inside;  // points for machines beyond 3 standard deviations
  far.colour = ink::failed;
  for (std::size_t i = 0; i < comparison.machines.size(); ++i) {
    const auto& m = comparison.machines[i];
    const auto x = static_cast<double>(i);
    plot.ticks.emplace_back(x, m.machine);
    bars.x.push_back(x);
    bars.y.push_back(numbers.in_unit(m.value - 2 * m.u));
    bars.y2.push_back(numbers.in_unit(m.value + 2 * m.u));
    Curve& marks = std::fabs(m.z) > 3 ? far : inside;
    marks.x.push_back(x);
    marks.y.push_back(numbers.in_unit(m.value));
  }
  if (std::none_of(bars.y.begin(), bars.y.end(), [](double v) { return std::isfinite(v); }))
    return {};
  plot.curves = {std::move(bars), std::move(inside), std::move(far)};
  return picture(page, comparison.model + ' ' + comparison.axis, plot, "names");
}

namespace {

/// Means over bins of equal width that have enough readings.
Curve means_of(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t bins = 24, fewest = 5;
  Curve out{.x = {}, .y = {}, .colour = ink::text, .width = 1.6};
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  if (low == x.end() || !(*high > *low)) return out;
  std::array<double, bins> sum{}, at{}, n{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto bin = std::min(
        static_cast<std::size_t>((x[i] - *low) / (*high - *low) * static_cast<double>(bins)),
        bins - 1);
    sum[bin] += y[i], at[bin] += x[i], ++n[bin];
  }
  for (std::size_t b = 0; b < bins; ++b)
    if (n[b] >= static_cast<double>(fewest))
      out.x.push_back(at[b] / n[b]), out.y.push_back(sum[b] / n[b]);
  return out;
}

}  // namespace

Html residuals_chart(const Page& page, const JointResiduals& part,
                     const std::vector<std::size_t>& rows, const std::vector<double>& across,
                     const std::string& heading, const std::string& title) {
  const Quantity q = deviation_of(part.angular);
  Plot plot;
  plot.language = page.words.language();
  plot.x_title = title;
  plot.y_title = page.words.get("picture.residual", {{"unit", unit_text(q)}});
  const double two_s = 2.0 * scaled(part.noise, q);
  if (two_s > 0.0) plot.belts.push_back({-two_s, two_s, ink::cone});
  std::vector<double> x, y;
  std::vector<Curve> of(part.campaigns.size());
  for (const std::size_t i : rows) {
    if (!std::isfinite(across[i])) continue;
    x.push_back(across[i]), y.push_back(scaled(part.residual[i], q));
    of[part.campaign[i]].x.push_back(x.back()), of[part.campaign[i]].y.push_back(y.back());
  }
  for (std::size_t c = 0; c < of.size(); ++c) {
    if (of[c].x.empty()) continue;
    of[c].kind = Curve::Kind::points, of[c].marker = Marker::dot, of[c].marker_size = 3.0;
    of[c].colour = c + 1 == of.size() ? ink::measured : ink::earlier;
    of[c].titles = {part.campaigns[c]};
    plot.curves.push_back(std::move(of[c]));
  }
  plot.curves.push_back(means_of(x, y));
  return picture(page, part.name + ": " + heading, plot, "");
}

}  // namespace nonio::reports::site
