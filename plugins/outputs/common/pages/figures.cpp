// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"
#include "rules.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

std::vector<double> in_print(const std::vector<double>& si, Quantity q) {
  std::vector<double> out;
  out.reserve(si.size());
  for (const double v : si) out.push_back(v * unit_of(q).per_si);
  return out;
}

class Points {
 public:
  Points(const Measured& m, std::initializer_list<std::string_view> wanted) {
    for (const auto* a : m.analyses) {
      const PointTable& p = a->evaluation.points;
      if (p.column("target") != nullptr &&
          std::all_of(wanted.begin(), wanted.end(),
                      [&](std::string_view name) { return p.column(name) != nullptr; })) {
        table_ = &p;
        values_ = &a->evaluation.values;
        return;
      }
    }
  }
  explicit operator bool() const { return table_ != nullptr; }
  std::vector<double> operator[](std::string_view name) const {
    const auto* c = table_ != nullptr ? table_->column(name) : nullptr;
    return c != nullptr ? in_print(c->values, c->quantity) : std::vector<double>();
  }
  bool result(std::string_view name) const {
    return values_ != nullptr && std::any_of(values_->begin(), values_->end(),
                                             [&](const Value& v) { return v.name == name; });
  }

 private:
  const PointTable* table_ = nullptr;
  const std::vector<Value>* values_ = nullptr;
};

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

template <class F>
std::vector<double> combine(const std::vector<double>& a, const std::vector<double>& b, F f) {
  std::vector<double> out(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = f(a[i], b[i]);
  return out;
}

/// Uses the variant "_own" without a standard's name if its plan was not followed.
std::string title_of(const Source& source, const Measured& m, const std::string& key,
                     Wording::Places places = {}) {
  const bool named =
      std::all_of(m.analyses.begin(), m.analyses.end(),
                  [&](const Results::Analysed* a) { return follows_plan(source.in, *a); }) &&
      std::none_of(m.analyses.begin(), m.analyses.end(), [](const Results::Analysed* a) {
        return rules_of(*a) != nullptr;  // points of several rules belong to no standard
      });
  return source.words.get(named ? key : key + "_own", places);
}

Colour lighter(Colour c, float share) {
  const auto mix = [&](float part) { return part + (1.0F - part) * share; };
  return {mix(c.red), mix(c.green), mix(c.blue)};
}

bool along_diagonal(const Measured& m) {
  return m.measurement.kind == "diagonal" && m.observations.axes.size() > 1;
}

std::string axis_of(const Measured& m) {
  const auto& axes = m.observations.axes;
  return m.measurement.axis.empty() && !axes.empty() ? axes.front().axis : m.measurement.axis;
}

Plot empty_plot(const Source& source, const Measured& m, std::string title) {
  const Quantity position = position_of(m.rotary), deviation = deviation_of(m.rotary);
  Plot plot;
  plot.title = std::move(title);
  plot.x_title = along_diagonal(m)
                     ? source.words.get("plot.along", {{"unit", unit_text(position)}})
                     : source.words.get("plot.position",
                                        {{"axis", axis_of(m)}, {"unit", unit_text(position)}});
  plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(deviation)}});
  plot.language = source.language();
  plot.degrees = m.rotary;
  plot.empty_text = source.words.get("plot.nothing");
  return plot;
}

void add_span(Plot& plot, const char* name, std::initializer_list<std::vector<double>> lines) {
  double low = INFINITY, high = -INFINITY;
  for (const auto& line : lines)
    for (const double v : line)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  if (low < high) plot.spans.push_back({low, high, name});
}

Curve mean_curve(const Source& source, std::vector<double> x, std::vector<double> y, bool plus) {
  const Style& style = source.look.style;
  Curve c;
  c.x = std::move(x);
  c.y = std::move(y);
  c.colour = plus ? style.plus : style.minus;
  c.width = 1.1;
  c.dash = plus ? Dash::solid : Dash::dashed;
  c.marker = plus ? Marker::up : Marker::down;
  c.legend = source.words.get(plus ? "plot.mean_plus" : "plot.mean_minus");
  return c;
}

using Run = std::vector<std::pair<double, double>>;

std::map<std::pair<bool, std::uint32_t>, Run> runs_of(const Measured& m) {
  std::map<std::pair<bool, std::uint32_t>, Run> runs;
  const Observations& o = m.observations;
  const auto& axis = o.axes.front();
  const std::vector<double> places = along_line(m);
  const auto& ends = m.measurement;
  const bool falls = along_diagonal(m) && ends.from.contains(axis.axis) &&
                     ends.to.contains(axis.axis) && ends.to.at(axis.axis) < ends.from.at(axis.axis);
  const double px = unit_of(position_of(axis.rotary)).per_si;
  const double py = unit_of(deviation_of(o.angular)).per_si;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const bool minus =
        i < axis.approach.size() && axis.approach[i] != 0 && (axis.approach[i] < 0) != falls;
    runs[{minus, i < o.run.size() ? o.run[i] : 0}].emplace_back(places[i] * px,
                                                                o.deviation[i] * py);
  }
  for (auto& [key, run] : runs)
    std::stable_sort(run.begin(), run.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  return runs;
}

/// Bands instead of lines for very many runs: single lines would merge and make the file several
/// megabytes large.
void add_ranges(const Source& source, const Measured& m, Plot& plot) {
  std::map<std::pair<bool, double>, std::pair<double, double>> ranges;
  for (const auto& [key, run] : runs_of(m))
    for (const auto& [x, y] : run) {
      const auto [it, fresh] = ranges.try_emplace({key.first, x}, y, y);
      it->second = {std::min(it->second.first, y), std::max(it->second.second, y)};
    }
  for (const bool minus : {false, true}) {
    Curve c;
    c.kind = Curve::Kind::band;
    c.colour = minus ? source.look.style.minus : source.look.style.plus;
    c.width = 0.4;
    c.dash = minus ? Dash::dashed : Dash::solid;
    c.legend = source.words.get(minus ? "plot.range_minus" : "plot.range_plus");
    for (const auto& [key, range] : ranges)
      if (key.first == minus) {
        c.x.push_back(key.second);
        c.y.push_back(range.first);
        c.y2.push_back(range.second);
      }
    if (!c.x.empty()) plot.curves.push_back(std::move(c));
  }
}

/// Colors from dark to light show a drift as an order, also with color blindness and in grayscale.
Colour colour_of_run(std::size_t place, std::size_t count) {
  constexpr Colour scale[] = {{0.27F, 0.00F, 0.33F},
                              {0.23F, 0.32F, 0.55F},
                              {0.13F, 0.57F, 0.55F},
                              {0.37F, 0.79F, 0.38F},
                              {0.80F, 0.75F, 0.10F}};
  constexpr std::size_t last = std::size(scale) - 1;
  if (count < 2) return scale[1];
  const float at = static_cast<float>(place * last) / static_cast<float>(count - 1);
  const std::size_t from = std::min(static_cast<std::size_t>(at), last - 1);
  const float share = at - static_cast<float>(from);
  const auto mix = [&](float a, float b) { return a + (b - a) * share; };
  return {mix(scale[from].red, scale[from + 1].red), mix(scale[from].green, scale[from + 1].green),
          mix(scale[from].blue, scale[from + 1].blue)};
}

void add_runs(const Source& source, const Measured& m, Plot& plot) {
  const Observations& o = m.observations;
  const auto runs = runs_of(m);
  constexpr std::size_t most_runs = 60, most_readings = 40000;
  if (runs.size() > most_runs || o.size() > most_readings) return add_ranges(source, m, plot);
  std::set<std::uint32_t> numbers;
  for (const auto& [key, run] : runs) numbers.insert(key.second);
  std::set<std::uint32_t> named;
  for (const auto& [key, run] : runs) {
    const bool minus = key.first;
    Curve c;
    for (const auto& [x, y] : run) {
      c.x.push_back(x);
      c.y.push_back(y);
    }
    const auto place = std::distance(numbers.begin(), numbers.find(key.second));
    const bool end = place == 0 || place + 1 == static_cast<std::ptrdiff_t>(numbers.size());
    c.colour = colour_of_run(static_cast<std::size_t>(place), numbers.size());
    c.width = 0.6;
    c.dash = minus ? Dash::dashed : Dash::solid;
    if ((end || numbers.size() <= 6) && named.insert(key.second).second)
      c.legend = source.words.get("plot.run", {{"run", std::to_string(key.second)}});
    plot.curves.push_back(std::move(c));
  }
}

std::optional<Plot> runs_plot(const Source& source, const Measured& m) {
  const Observations& o = m.observations;
  if (o.axes.empty() || o.size() == 0) return {};
  Plot plot = empty_plot(source, m, source.words.get("plot.runs"));
  plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(deviation_of(o.angular))}});
  add_runs(source, m, plot);
  const std::size_t readings = plot.curves.size();
  const Points points(m, {"mean+", "mean-"});
  for (const bool plus : {true, false})
    if (auto mean = points[plus ? "mean+" : "mean-"]; any_finite(mean))
      plot.curves.push_back(mean_curve(source, points["target"], std::move(mean), plus));
  if (plot.curves.size() == readings) plot.title = source.words.get("plot.readings");
  return plot;
}

/// Coverage factor of the edition from R+ = 2 k s+; 0 without scatter.
double coverage_factor(const Points& points) {
  for (const auto& [R, s] : {std::pair("R+", "s+"), std::pair("R-", "s-")}) {
    const auto range = points[R], scatter = points[s];
    for (std::size_t i = 0; i < std::min(range.size(), scatter.size()); ++i)
      if (scatter[i] > 0 && std::isfinite(range[i])) return range[i] / (2 * scatter[i]);
  }
  return 0;
}

std::optional<Plot> iso_plot(const Source& source, const Measured& m) {
  const Points points(m, {"mean+", "mean-", "s+", "s-"});
  const auto x = points["target"];
  if (!points || (!any_finite(points["mean+"]) && !any_finite(points["mean-"]))) return {};
  const double k = coverage_factor(points);
  const std::string k_text = localised(short_text(k, 1), source.language());
  Plot plot = empty_plot(source, m,
                         k > 0 ? title_of(source, m, "plot.iso", {{"k", k_text}})
                               : title_of(source, m, "plot.iso_means"));
  std::vector<double> bounds, means;
  for (const bool plus : {true, false}) {
    const auto mean = points[plus ? "mean+" : "mean-"], s = points[plus ? "s+" : "s-"];
    if (!any_finite(mean)) continue;
    means.insert(means.end(), mean.begin(), mean.end());
    if (k > 0 && any_finite(s)) {
      Curve band;
      band.kind = Curve::Kind::band;
      band.x = x;
      band.y = combine(mean, s, [&](double a, double b) { return a + k * b; });
      band.y2 = combine(mean, s, [&](double a, double b) { return a - k * b; });
      band.colour = plus ? source.look.style.plus : source.look.style.minus;
      band.width = 0.5;
      band.dash = plus ? Dash::solid : Dash::dashed;
      band.legend = source.words.get(plus ? "plot.band_plus" : "plot.band_minus", {{"k", k_text}});
      bounds.insert(bounds.end(), band.y.begin(), band.y.end());
      bounds.insert(bounds.end(), band.y2.begin(), band.y2.end());
      plot.curves.push_back(std::move(band));
    }
    plot.curves.push_back(mean_curve(source, x, mean, plus));
  }
  if (any_finite(points["mean+"]) && any_finite(points["mean-"])) {
    if (points.result("E")) add_span(plot, "E", {means});
    if (points.result("A")) add_span(plot, "A", {bounds});
  }
  return plot;
}

std::optional<Plot> vdi_plot(const Source& source, const Measured& m) {
  const Points points(m, {"mean", "U", "Ps"});
  const auto x = points["target"], mean = points["mean"], U = points["U"], Ps = points["Ps"];
  if (!points || !any_finite(mean)) return {};
  const Style& style = source.look.style;
  const bool scatter = any_finite(Ps);
  Plot plot = empty_plot(source, m, title_of(source, m, scatter ? "plot.vdi" : "plot.vdi_means"));
  const auto band = [&](std::vector<double> half, Colour colour, Dash dash, const char* key) {
    Curve c;
    c.kind = Curve::Kind::band;
    c.x = x;
    c.y = combine(mean, half, [](double a, double b) { return a + b; });
    c.y2 = combine(mean, half, [](double a, double b) { return a - b; });
    c.colour = colour;
    c.width = 0.6;
    c.dash = dash;
    c.legend = source.words.get(key);
    plot.curves.push_back(c);
    return c;
  };
  if (scatter) {
    const Curve outer = band(combine(U, Ps, [](double u, double ps) { return (u + ps) / 2; }),
                             lighter(style.muted, 0.1F), Dash::dotted, "plot.scatter");
    if (points.result("Pa")) add_span(plot, "Pa", {mean});
    if (points.result("P")) add_span(plot, "P", {outer.y, outer.y2});
  }
  band(combine(U, U, [](double u, double) { return u / 2; }), style.accent, Dash::solid,
       "plot.span");
  Curve c;
  c.x = x;
  c.y = mean;
  c.colour = style.text;
  c.width = 1.0;
  c.marker = Marker::dot;
  c.marker_size = 1.8;
  c.legend = source.words.get("plot.mean");
  plot.curves.push_back(std::move(c));
  return plot;
}

std::optional<Plot> reversal_plot(const Source& source, const Measured& m) {
  const Points points(m, {"B"});
  const auto x = points["target"], B = points["B"];
  if (!points || !any_finite(B)) return {};
  Plot plot = empty_plot(source, m, source.words.get("plot.reversal"));
  plot.y_title =
      source.words.get("plot.reversal_axis", {{"unit", unit_text(deviation_of(m.rotary))}});
  Curve each;
  each.kind = Curve::Kind::bars;
  each.x = x;
  each.y = std::vector<double>(x.size(), 0.0);
  each.y2 = B;
  each.colour = source.look.style.accent;
  each.width = 1.2;
  Curve tips;
  tips.x = x;
  tips.y = B;
  tips.colour = source.look.style.accent;
  tips.width = 0;
  tips.marker = Marker::dot;
  tips.legend = source.words.get("plot.each");
  double sum = 0, n = 0, low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < std::min(B.size(), x.size()); ++i) {
    if (!std::isfinite(B[i])) continue;
    sum += B[i];
    ++n;
    low = std::min(low, x[i]);
    high = std::max(high, x[i]);
  }
  Curve mean;
  mean.x = {low, high};
  mean.y = {sum / n, sum / n};
  mean.colour = source.look.style.minus;
  mean.width = 1.1;
  mean.dash = Dash::dash_dot;
  mean.legend = source.words.get("plot.average");
  plot.curves = {std::move(each), std::move(mean), std::move(tips)};
  return plot;
}

void series_plots(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  for (const auto* a : m.analyses)
    for (const Series& s : a->evaluation.series) {
      if (source.certificate && s.U.size() != s.value.size()) continue;
      const bool numbered = s.name.starts_with("line_");
      const std::string name =
          numbered ? source.words.get("column.line") + " " + s.name.substr(5) : symbol(s.name);
      Plot plot = empty_plot(source, m, source.words.get("plot.series", {{"name", name}}));
      plot.x_title = source.words.get("plot.position",
                                      {{"axis", s.over}, {"unit", unit_text(s.position_quantity)}});
      plot.y_title =
          source.words.get("plot.curve_axis", {{"name", name}, {"unit", unit_text(s.quantity)}});
      plot.degrees = s.position_quantity == Quantity::angle;
      const auto x = in_print(s.position, s.position_quantity), y = in_print(s.value, s.quantity);
      if (any_finite(s.U)) {
        const auto U = in_print(s.U, s.quantity);
        Curve band;
        band.kind = Curve::Kind::band;
        band.x = x;
        band.y = combine(y, U, [](double v, double u) { return v + u; });
        band.y2 = combine(y, U, [](double v, double u) { return v - u; });
        band.colour = source.look.style.plus;
        band.width = 0.3;
        band.legend = source.words.get("plot.uncertainty");
        plot.curves.push_back(std::move(band));
      }
      Curve line;
      line.x = x;
      line.y = y;
      line.colour = source.look.style.plus;
      line.width = 1.1;
      line.marker = Marker::dot;
      plot.curves.push_back(std::move(line));
      plots.push_back(std::move(plot));
    }
}

}  // namespace

std::optional<Plot> readings_plot(const Source& source, const Measured& m) {
  if (over_one_position(m.measurement)) return runs_plot(source, m);
  if (m.measurement.kind == "circle") return path_plot(source, m);
  if (is_heat(m.measurement)) return heat_plot(source, m);
  std::vector<Plot> plots;
  if (m.measurement.kind == "ball-centres") {
    add_circle(source, m, plots);
    add_chain(source, m, plots);
  }
  add_volume(source, m, plots);
  if (plots.empty()) return {};
  return std::move(plots.front());
}

void add_plots(const Source& source, const Measured& m, Blocks& blocks) {
  if (m.measurement.kind == "circle") return add_path(source, m, blocks);
  if (is_heat(m.measurement)) return add_heat(source, m, blocks);
  std::vector<Plot> plots;
  const bool circle = m.measurement.kind == "ball-centres";
  const auto add = [&](std::optional<Plot> plot) {
    if (plot) plots.push_back(std::move(*plot));
  };
  for (const std::string& kind : source.look.plots) {
    if (kind == "runs" && over_one_position(m.measurement)) {
      add(runs_plot(source, m));
      add_before_after(source, m, plots);
    }
    if (kind == "iso") add(iso_plot(source, m));
    if (kind == "vdi") add(vdi_plot(source, m));
    if (kind == "reversal") add(reversal_plot(source, m));
    if (kind == "diagonals") add_diagonals(source, m, plots);
    if (kind == "volume") add_volume(source, m, plots);
    if (kind == "circle" && circle) {
      add_circle(source, m, plots);
      add_chain(source, m, plots);
    }
    if (kind == "series" && !circle) series_plots(source, m, plots);
  }
  if (!plots.empty()) blocks.push_back({Spacer{4}});
  const std::string field = "plots of measurement " + m.measurement.id;
  const auto per_row = static_cast<std::size_t>(source.look.plots_per_row);
  for (std::size_t i = 0; i < plots.size(); i += per_row) {
    Columns row;
    for (std::size_t k = i; k < std::min(i + per_row, plots.size()); ++k)
      row.parts.push_back({{std::move(plots[k]), field}});
    blocks.push_back({std::move(row), field});
  }
}

}  // namespace nonio::pages
