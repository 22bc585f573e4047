// SPDX-License-Identifier: Apache-2.0
// Figures of thermal tests over time with temperatures, of spindle error motions in polar plots,
// and of length errors between their limits.
#include <algorithm>
#include <cmath>
#include <map>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

constexpr double um_of_m = 1e6;

const Results::Analysed* heat_of(const Measured& m) {
  for (const auto* a : m.analyses)
    if (a->plugin == m.measurement.kind && !a->evaluation.values.empty()) return a;
  return nullptr;
}

void style_of(const Source& source, std::size_t number, Curve& c) {
  const Style& s = source.look.style;
  const Colour colours[] = {s.plus, s.minus, s.accent, s.muted};
  constexpr Dash dashes[] = {Dash::solid, Dash::dashed, Dash::dash_dot, Dash::dotted};
  c.colour = colours[number % std::size(colours)];
  c.dash = dashes[(number / std::size(colours) + number) % std::size(dashes)];
  c.width = 1.1;
}

constexpr std::size_t most_points = 1500;

Plot over_time(const Source& source, const char* title, const std::string& y_title) {
  Plot plot;
  plot.title = source.words.get(title);
  plot.x_title = source.words.get("plot.minutes");
  plot.y_title = y_title;
  plot.language = source.language();
  return plot;
}

double first_time(const Observations& o) {
  double first = INFINITY;
  for (const double t : o.time) first = std::min(first, t);
  return first;
}

Plot changes(const Source& source, const Measured& m) {
  const Observations& o = m.observations;
  Plot plot =
      over_time(source, "plot.thermal",
                source.words.get("plot.change", {{"unit", unit_text(Quantity::deviation)}}));
  const bool axis = !m.measurement.axis.empty();
  std::map<std::pair<double, int>, std::vector<std::size_t>> rows;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto key = axis ? std::pair(o.axes[0].position[i], -int{o.axes[0].approach[i]})
                          : std::pair(static_cast<double>(o.line_of(i)), 0);
    rows[key].push_back(i);
  }
  const double start = first_time(o);
  std::size_t number = 0;
  constexpr std::size_t most = 8;
  for (const auto& [key, list] : rows) {
    if (number >= most) break;
    Curve c;
    const std::size_t step = list.size() / most_points + 1;
    for (std::size_t k = 0; k < list.size(); k += step) {
      c.x.push_back((o.time[list[k]] - start) / 60.0);
      c.y.push_back((o.deviation[list[k]] - o.deviation[list.front()]) * um_of_m);
    }
    style_of(source, number++, c);
    std::string name = axis ? std::string() : o.lines[static_cast<std::size_t>(key.first)].name;
    if (axis) {
      append_shortest(name, std::round(key.first * 1e6) / 1e3);
      name = localised(name, source.language()) + " mm " + (key.second < 0 ? "↑" : "↓");
    }
    c.legend = std::move(name);
    plot.curves.push_back(std::move(c));
  }
  return plot;
}

std::optional<Plot> fits(const Source& source, const Results::Analysed& a, Plot* into) {
  Plot own = over_time(
      source, "plot.growth",
      source.words.get("plot.change", {{"unit", unit_text(Quantity::deviation_per_length)}}));
  std::size_t number = 0;
  for (const Series& s : a.evaluation.series) {
    if (s.over != "t" || s.name.starts_with("reversal")) continue;
    const bool fit = s.name.starts_with("fit_"), growth = s.quantity != Quantity::deviation;
    if (!growth && !fit) continue;
    Curve c;
    const std::size_t step = s.position.size() / most_points + 1;
    for (std::size_t i = 0; i < s.position.size(); i += step)
      c.x.push_back(s.position[i] / 60.0), c.y.push_back(s.value[i] * um_of_m);
    const std::string name = s.name.substr(s.name.find('_') + 1);
    if (growth) {
      style_of(source, number++, c);
      c.legend = fit ? source.words.get("plot.fit", {{"name", name}}) : name;
      own.curves.push_back(std::move(c));
      continue;
    }
    if (into == nullptr) continue;
    c.colour = source.look.style.text, c.width = 0.6;
    into->curves.push_back(std::move(c));
  }
  if (own.curves.empty()) return {};
  return own;
}

std::optional<Plot> temperatures_plot(const Source& source, const Observations& o) {
  Plot plot = over_time(source, "plot.temperature", source.words.get("plot.temperature_axis"));
  plot.zero_line = false;
  const double start = first_time(o);
  std::size_t number = 0;
  for (const auto& [values, word] :
       {std::pair{&o.air, "plot.air"}, {&o.material, "plot.material"}}) {
    if (values->size() != o.size()) continue;
    Curve c;
    std::size_t rows = 0;
    while (rows < o.size() && o.line_of(rows) == o.line_of(0)) ++rows;
    const std::size_t step = rows / most_points + 1;
    for (std::size_t i = 0; i < rows; i += step)
      if (std::isfinite((*values)[i]))
        c.x.push_back((o.time[i] - start) / 60.0), c.y.push_back((*values)[i]);
    if (c.x.empty()) continue;
    style_of(source, number++, c);
    c.legend = source.words.get(word);
    plot.curves.push_back(std::move(c));
  }
  if (plot.curves.empty()) return {};
  return plot;
}

Plot motion(const Source& source, const Measured& m, const Series& sync) {
  const Observations& o = m.observations;
  const std::string name = sync.name.substr(sync.name.find('_') + 1);
  Curve all, mean;
  double largest = 0.0;
  for (const double v : sync.value) largest = std::max(largest, std::fabs(v) * um_of_m);
  std::vector<std::pair<double, double>> points;
  for (std::size_t line = 0; line < o.lines.size() && points.empty(); ++line) {
    if (o.lines[line].name.substr(0, o.lines[line].name.find(' ')) != name) continue;
    double n = 0.0, mid = 0.0, a = 0.0, b = 0.0;
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (o.line_of(i) != line) continue;
      const double t = o.axes[0].position[i], r = o.deviation[i] * um_of_m;
      n += 1.0, mid += r, a += 2.0 * r * std::cos(t), b += 2.0 * r * std::sin(t);
      points.emplace_back(t, r);
    }
    mid /= n, a /= n, b /= n;
    if (name == "Z") a = b = 0.0;  // axial motion once per revolution is an error
    for (auto& [t, r] : points) {
      r -= mid + a * std::cos(t) + b * std::sin(t);
      largest = std::max(largest, std::fabs(r));
    }
  }
  const double division = division_of(largest);
  const std::string text = division_text(source, division);
  Plot plot = rings(source, source.words.get("plot.motion", {{"name", name}, {"division", text}}),
                    source.words.get("plot.motion_scale", {{"division", text}}));
  constexpr std::size_t most = 12000;
  const std::size_t step = points.size() / most + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const double radius = 4.0 + points[i].second / division;
    all.x.push_back(radius * std::cos(points[i].first));
    all.y.push_back(radius * std::sin(points[i].first));
  }
  for (std::size_t i = 0; i <= sync.value.size(); ++i) {
    const std::size_t k = i % sync.value.size();
    const double radius = 4.0 + sync.value[k] * um_of_m / division;
    mean.x.push_back(radius * std::cos(sync.position[k]));
    mean.y.push_back(radius * std::sin(sync.position[k]));
  }
  all.colour = source.look.style.plus, all.width = 0.3;
  all.legend = source.words.get("plot.turns");
  mean.colour = source.look.style.minus, mean.width = 1.4;
  mean.legend = source.words.get("plot.synchronous");
  if (!all.x.empty()) plot.curves.push_back(std::move(all));
  plot.curves.push_back(std::move(mean));
  return plot;
}

std::vector<Plot> motions(const Source& source, const Measured& m) {
  std::vector<Plot> out;
  constexpr std::size_t most = 4;
  for (const Series& s : heat_of(m)->evaluation.series)
    if (s.name.starts_with("sync_") && s.quantity == Quantity::deviation && !s.value.empty() &&
        out.size() < most)
      out.push_back(motion(source, m, s));
  return out;
}

std::optional<Plot> lengths_plot(const Source& source, const Measured& m) {
  const Observations& o = m.observations;
  const PointTable& points = heat_of(m)->evaluation.points;
  const auto *target = points.column("target"), *limit = points.column("MPE");
  if (target == nullptr || o.axes.empty()) return {};
  Plot plot;
  plot.title = source.words.get("plot.lengths");
  plot.x_title = source.words.get("plot.length");
  plot.y_title = source.words.get("plot.length_error");
  plot.language = source.language();
  Curve errors;
  errors.kind = Curve::Kind::points;
  for (std::size_t i = 0; i < o.size(); ++i) {
    errors.x.push_back(o.axes[0].position[i] * 1e3);
    errors.y.push_back(o.deviation[i] * um_of_m);
  }
  errors.colour = source.look.style.plus, errors.marker = Marker::dot;
  plot.curves.push_back(std::move(errors));
  std::map<double, double> limits;
  if (limit != nullptr)
    for (std::size_t i = 0; i < target->values.size(); ++i)
      if (std::isfinite(limit->values[i]))
        limits[target->values[i] * 1e3] = limit->values[i] * um_of_m;
  for (const double sign : {1.0, -1.0}) {
    if (limits.empty()) break;
    Curve c;
    for (const auto& [L, mpe] : limits) c.x.push_back(L), c.y.push_back(sign * mpe);
    c.colour = source.look.style.minus, c.width = 1.1, c.dash = Dash::dashed;
    if (sign > 0.0) c.legend = source.words.get("plot.limit");
    plot.curves.push_back(std::move(c));
  }
  return plot;
}

}  // namespace

std::optional<Plot> heat_plot(const Source& source, const Measured& m) {
  if (heat_of(m) == nullptr || m.observations.size() == 0) return {};
  if (m.measurement.kind == "thermal") return changes(source, m);
  if (m.measurement.kind == "lengths") return lengths_plot(source, m);
  auto all = motions(source, m);
  if (all.empty()) return {};
  return std::move(all.front());
}

void add_heat(const Source& source, const Measured& m, Blocks& blocks) {
  auto plot = heat_plot(source, m);
  if (!plot) return;
  const std::string field = "plots of measurement " + m.measurement.id;
  std::vector<Plot> plots;
  if (m.measurement.kind == "spindle") {
    plots = motions(source, m);
  } else {
    const auto growth = fits(source, *heat_of(m), &*plot);
    plots.push_back(std::move(*plot));
    if (growth) plots.push_back(*growth);
  }
  if (m.measurement.kind == "thermal")
    if (auto warm = temperatures_plot(source, m.observations)) plots.push_back(std::move(*warm));
  blocks.push_back({Spacer{4}});
  for (std::size_t i = 0; i < plots.size(); i += 2) {
    Columns row;
    for (std::size_t k = i; k < std::min(i + 2, plots.size()); ++k)
      row.parts.push_back({{std::move(plots[k]), field}});
    blocks.push_back({std::move(row), field});
  }
}

}  // namespace nonio::pages
