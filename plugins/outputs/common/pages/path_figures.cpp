// SPDX-License-Identifier: Apache-2.0
// Polar plot of a circular test: enlarged radial deviations of both directions about the
// least-squares center; and a chart of the causes by their individual effect.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

constexpr double per_um = 1e6;

/// A run in one direction: angle in the plane, rad, and deviation from center and mean radius, um.
struct Path {
  bool plus = true;
  std::vector<std::pair<double, double>> points;
};

struct Paths {
  std::string first, second;
  std::vector<Path> all;
  double largest = 0.0;
};

const Results::Analysed* analysis_of(const Measured& m) {
  for (const auto* a : m.analyses)
    if (a->plugin == "circle" && !a->evaluation.values.empty()) return a;
  return nullptr;
}

double centre_of(const Results::Analysed& a, const std::string& axis) {
  for (const Value& v : a.evaluation.values)
    if (v.name == "centre_" + axis) return v.value * per_um;
  return 0.0;
}

Paths paths_of(const Measured& m, const Results::Analysed& a) {
  const Observations& o = m.observations;
  Paths out;
  for (const auto& [axis, from] : m.measurement.from) {
    const auto to = m.measurement.to.find(axis);
    (to != m.measurement.to.end() && to->second != from ? out.first : out.second) = axis;
  }
  const std::size_t u = coordinate_of(out.first), v = coordinate_of(out.second);
  const auto *x = o.axis(out.first), *y = o.axis(out.second);
  if (u > 2 || v > 2 || x == nullptr || y == nullptr) return out;
  const double cu = centre_of(a, out.first), cv = centre_of(a, out.second);
  std::map<std::pair<std::uint32_t, bool>, Path> paths;
  double mean = 0.0;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto& n = o.sense_of(i);
    const bool plus = n[u] * y->approach[i] - n[v] * x->approach[i] > 0.0;
    const double r = o.deviation[i] * per_um - cu * n[u] - cv * n[v];
    mean += r / static_cast<double>(o.size());
    Path& path = paths[{o.run_of(i), plus}];
    path.plus = plus;
    path.points.emplace_back(std::atan2(n[v], n[u]), r);
  }
  for (auto& [key, path] : paths) {
    for (auto& [angle, r] : path.points)
      r -= mean, out.largest = std::max(out.largest, std::fabs(r));
    std::sort(path.points.begin(), path.points.end());
    out.all.push_back(std::move(path));
  }
  return out;
}

void add_ring(Plot& plot, double radius, Colour colour, double width, Dash dash) {
  Curve ring;
  for (int i = 0; i <= 180; ++i) {
    ring.x.push_back(radius * std::cos(i * std::numbers::pi / 90));
    ring.y.push_back(radius * std::sin(i * std::numbers::pi / 90));
  }
  ring.colour = colour, ring.width = width, ring.dash = dash;
  plot.curves.push_back(std::move(ring));
}

}  // namespace

double division_of(double largest) { return round_factor(std::max(largest, 0.003) / 3.0 * 2.4999); }

std::string division_text(const Source& source, double division) {
  std::string text;
  append_shortest(text, std::round(division * 1e6) / 1e6);
  return localised(text, source.language());
}

Plot rings(const Source& source, std::string title, std::string caption) {
  const Style& style = source.look.style;
  Plot plot;
  plot.title = std::move(title);
  plot.x_title = std::move(caption);
  plot.language = source.language();
  plot.same_scale = true, plot.scales = false;
  plot.height = 1.9 * style.plot_height;
  const Colour faint{0.82F, 0.82F, 0.82F};
  for (int ring = 1; ring <= 7; ++ring)
    if (ring != 4) add_ring(plot, ring, faint, 0.4, Dash::solid);
  add_ring(plot, 4.0, style.muted, 1.0, Dash::solid);
  for (const bool across : {true, false}) {
    Curve cross;
    cross.x = across ? std::vector<double>{-7.4, 7.4} : std::vector<double>{0.0, 0.0};
    cross.y = across ? std::vector<double>{0.0, 0.0} : std::vector<double>{-7.4, 7.4};
    cross.colour = style.muted, cross.width = 0.4;
    plot.curves.push_back(std::move(cross));
  }
  return plot;
}

namespace {

Plot polar(const Source& source, const Paths& paths) {
  const Style& style = source.look.style;
  const double division = division_of(paths.largest);
  const std::string text = division_text(source, division);
  Plot plot = rings(source, source.words.get("plot.polar", {{"division", text}}),
                    source.words.get("plot.polar_scale", {{"division", text}}));
  plot.labels = {{7.4, 0.0, "+" + paths.first}, {0.0, 7.4, "+" + paths.second}};
  std::array<bool, 2> named{};
  for (const Path& path : paths.all) {
    Curve c;
    const std::size_t step = path.points.size() / 2000 + 1;
    double last = NAN;
    for (std::size_t i = 0; i < path.points.size(); i += step) {
      const auto& [angle, r] = path.points[i];
      const double radius = 4.0 + r / division;
      // A gap in the readings interrupts the line.
      if (std::isfinite(last) && angle - last > 0.2) c.x.push_back(NAN), c.y.push_back(NAN);
      last = angle;
      c.x.push_back(radius * std::cos(angle)), c.y.push_back(radius * std::sin(angle));
    }
    if (!path.points.empty() &&
        path.points.front().first + 2.0 * std::numbers::pi - path.points.back().first < 0.2)
      c.x.push_back(c.x.front()), c.y.push_back(c.y.front());
    c.colour = path.plus ? style.plus : style.minus;
    c.dash = path.plus ? Dash::solid : Dash::dashed;
    c.width = 1.1;
    if (!std::exchange(named[path.plus ? 0 : 1], true))
      c.legend = source.words.get(path.plus ? "plot.ccw" : "plot.cw");
    plot.curves.push_back(std::move(c));
  }
  return plot;
}

std::string text_of(const Finding& f, const char* name) {
  for (const auto& [key, text] : f.texts)
    if (key == name) return text;
  return "";
}

const Number* number_of(const Finding& f, std::string_view name) {
  const auto it = std::find_if(f.evidence.begin(), f.evidence.end(),
                               [&](const Number& n) { return n.name == name; });
  return it == f.evidence.end() ? nullptr : &*it;
}

/// A certificate may have two languages, so it uses the symbols of its table.
std::string label_of(const Source& source, const Finding& f, std::string_view cause) {
  if (!source.certificate)
    return source.words.get("cause." + std::string(cause), {{"axis", text_of(f, "axis")}});
  const std::string name = text_of(f, "name");
  return symbol(name.empty() ? "spike_" + text_of(f, "axis") : name);
}

std::optional<BarChart> causes(const Source& source, const Results::Analysed& a) {
  constexpr std::string_view prefix = "circle.";
  std::vector<std::pair<double, BarChart::Row>> rows;
  for (const Finding& f : a.evaluation.findings) {
    const Number *alone = number_of(f, "alone"), *share = number_of(f, "share");
    if (!f.id.starts_with(prefix) || alone == nullptr) continue;
    const double um = alone->value * per_um;
    std::string text = localised(fixed_text(um, um < 10.0 ? 1 : 0), source.language());
    // The total excludes spikes, as stated in the sentence below the chart.
    if (share != nullptr && f.id != "circle.spikes")
      text += "  (" + fixed_text(100.0 * share->value, 0) + " %)";
    rows.emplace_back(um, BarChart::Row{label_of(source, f, f.id.substr(prefix.size())),
                                        {{um, std::move(text)}}});
  }
  if (rows.empty()) return {};
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& one, const auto& other) { return one.first > other.first; });
  BarChart chart;
  chart.title = source.words.get(source.certificate ? "plot.causes_short" : "plot.causes");
  chart.x_title = source.words.get("plot.causes_axis");
  chart.language = source.language();
  chart.series = {{"", source.look.style.plus}};
  for (auto& [um, row] : rows) chart.rows.push_back(std::move(row));
  return chart;
}

}  // namespace

std::optional<Plot> path_plot(const Source& source, const Measured& m) {
  const auto* a = analysis_of(m);
  if (a == nullptr) return {};
  const Paths paths = paths_of(m, *a);
  if (paths.all.empty()) return {};
  return polar(source, paths);
}

void add_path(const Source& source, const Measured& m, Blocks& blocks) {
  auto plot = path_plot(source, m);
  if (!plot) return;
  const std::string field = "plots of measurement " + m.measurement.id;
  Columns row;
  row.parts.push_back({{std::move(*plot), field}});
  if (auto chart = causes(source, *analysis_of(m)))
    row.parts.push_back({{std::move(*chart), field}});
  blocks.push_back({Spacer{4}});
  blocks.push_back({std::move(row), field});
}

}  // namespace nonio::pages
