// SPDX-License-Identifier: Apache-2.0
// Figures of diagonals before and after a compensation, of a line in both states, and of the plane
// with exaggerated errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "nonio/reports/number.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

struct Diagonals {
  const Results::Analysed* analysed;
  const PointTable::Column *target, *D1, *D2;
};

std::optional<Diagonals> diagonals_of(const Results::Analysed& a) {
  const PointTable& p = a.evaluation.points;
  const Diagonals d{&a, p.column("target"), p.column("D1"), p.column("D2")};
  if (d.target == nullptr || d.D1 == nullptr || d.D2 == nullptr) return {};
  return d;
}

std::vector<double> in_print(const PointTable::Column& c) {
  std::vector<double> out;
  for (const double v : c.values) out.push_back(v * unit_of(c.quantity).per_si);
  return out;
}

Curve curve_of(const PointTable::Column& x, const PointTable::Column& y, Colour colour, Dash dash,
               std::string legend) {
  Curve c;
  c.x = in_print(x);
  c.y = in_print(y);
  c.colour = colour;
  c.dash = dash;
  c.width = 1.1;
  c.legend = std::move(legend);
  return c;
}

Colour pale(Colour c) {
  const auto mix = [](float part) { return part + (1.0F - part) * 0.55F; };
  return {mix(c.red), mix(c.green), mix(c.blue)};
}

Plot diagonals_plot(const Source& source, const Diagonals& d) {
  const Style& style = source.look.style;
  Plot plot;
  plot.title = source.words.get("plot.diagonals");
  plot.x_title = source.words.get("plot.along", {{"unit", unit_text(d.target->quantity)}});
  plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(d.D1->quantity)}});
  plot.language = source.language();
  plot.empty_text = source.words.get("plot.nothing");
  for (const Results::Analysed& earlier : source.in.results.analyses) {
    if (&earlier == d.analysed) break;
    const auto before = diagonals_of(earlier);
    if (!before) continue;
    for (const auto& [column, colour] :
         {std::pair{before->D1, style.plus}, {before->D2, style.minus}})
      plot.curves.push_back(curve_of(*before->target, *column, pale(colour), Dash::dotted,
                                     column->name + ", " + earlier.measurement));
    break;
  }
  plot.curves.push_back(curve_of(*d.target, *d.D1, style.plus, Dash::solid, "D1"));
  plot.curves.push_back(curve_of(*d.target, *d.D2, style.minus, Dash::dashed, "D2"));
  plot.curves[plot.curves.size() - 2].marker = Marker::up;
  plot.curves.back().marker = Marker::down;
  return plot;
}

struct DrawnPass {
  const PointTable::Column* column;
  Colour colour;
  Dash dash;
  Marker marker;
};

std::vector<DrawnPass> passes_of(const Source& source, const Results::Analysed& a) {
  const Style& style = source.look.style;
  const std::array<std::tuple<const char*, Colour, Dash, Marker>, 4> four{
      {{"PPP", style.plus, Dash::solid, Marker::up},
       {"NPP", style.minus, Dash::dashed, Marker::down},
       {"PNP", style.good, Dash::dotted, Marker::dot},
       {"PPN", style.accent, Dash::dash_dot, Marker::ring}}};
  std::vector<DrawnPass> out;
  for (const auto& [name, colour, dash, marker] : four)
    if (const auto* column = a.evaluation.points.column(name))
      out.push_back({column, colour, dash, marker});
  return out;
}

/// Step diagonals before the compensation are pale.
std::optional<Plot> steps_plot(const Source& source, const Results::Analysed& a) {
  const PointTable::Column* target = a.evaluation.points.column("target");
  const auto passes = passes_of(source, a);
  if (target == nullptr || passes.empty()) return {};
  Plot plot;
  plot.title = source.words.get("plot.step_diagonals");
  plot.x_title = source.words.get("plot.along", {{"unit", unit_text(target->quantity)}});
  plot.y_title =
      source.words.get("plot.deviation", {{"unit", unit_text(passes.front().column->quantity)}});
  plot.language = source.language();
  plot.empty_text = source.words.get("plot.nothing");
  for (const Results::Analysed& earlier : source.in.results.analyses) {
    if (&earlier == &a) break;
    const PointTable::Column* before = earlier.evaluation.points.column("target");
    const auto drawn = passes_of(source, earlier);
    if (before == nullptr || drawn.empty()) continue;
    for (const DrawnPass& pass : drawn)
      plot.curves.push_back(curve_of(*before, *pass.column, pale(pass.colour), Dash::dotted,
                                     pass.column->name + ", " + earlier.measurement));
    break;
  }
  for (const DrawnPass& pass : passes) {
    plot.curves.push_back(
        curve_of(*target, *pass.column, pass.colour, pass.dash, pass.column->name));
    plot.curves.back().marker = pass.marker;
  }
  return plot;
}

const Series* series_of(const Evaluation& e, std::string_view name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

class Plane {
 public:
  Plane(const Series& f, const Series& g, double k) : f_(f), g_(g), k_(k) {
    double most = 0.0;
    for (std::size_t i = 0; i < f.value.size(); ++i) most = std::max(most, std::fabs(f.value[i]));
    for (std::size_t j = 0; j < g.value.size(); ++j) most = std::max(most, std::fabs(along_x(j)));
    const double size =
        std::max(f.position.back() - f.position.front(), g.position.back() - g.position.front());
    if (most > 0.0) factor_ = round_factor(0.06 * size / most);
  }
  double factor() const { return factor_; }

  std::vector<Curve> lines(Colour colour, double width, double factor) const {
    std::vector<Curve> out;
    const auto draw = [&](bool x_moves, std::size_t other) {
      const std::size_t n = (x_moves ? f_ : g_).position.size();
      Curve c;
      c.colour = colour;
      c.width = width;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = x_moves ? k : other, j = x_moves ? other : k;
        c.x.push_back(1e3 * (f_.position[i] + factor * along_x(j)));
        c.y.push_back(1e3 * (g_.position[j] + factor * f_.value[i]));
      }
      out.push_back(std::move(c));
    };
    for (std::size_t part = 0; part <= parts; ++part) {
      draw(true, part * (g_.position.size() - 1) / parts);
      draw(false, part * (f_.position.size() - 1) / parts);
    }
    return out;
  }

 private:
  static constexpr std::size_t parts = 6;
  double along_x(std::size_t j) const {
    return g_.value[j] - k_ * (g_.position[j] - g_.position.front());
  }
  const Series &f_, &g_;
  double k_, factor_ = 1.0;
};

std::optional<Plot> plane_plot(const Source& source, const Evaluation& e) {
  const Series *f = series_of(e, "EYX"), *g = series_of(e, "EXY");
  const auto k = std::find_if(e.values.begin(), e.values.end(),
                              [](const Value& v) { return v.name == "C0Y"; });
  if (f == nullptr || g == nullptr || k == e.values.end() || f->value.size() < 2) return {};
  const Plane plane(*f, *g, k->value);
  Plot plot;
  plot.title = source.words.get(
      "plot.plane",
      {{"factor", printed_number(plane.factor(), Quantity::count, 0, source.language())}});
  const std::string mm = unit_text(Quantity::length);
  plot.x_title = source.words.get("plot.position", {{"axis", f->over}, {"unit", mm}});
  plot.y_title = source.words.get("plot.position", {{"axis", g->over}, {"unit", mm}});
  plot.language = source.language();
  plot.empty_text = source.words.get("plot.nothing");
  plot.same_scale = true;
  plot.zero_line = false;
  plot.height = 1.4 * source.look.style.plot_height;
  plot.curves = plane.lines(source.look.style.muted, 0.3, 0.0);
  plot.curves.front().legend = source.words.get("plot.nominal");
  auto drawn = plane.lines(source.look.style.accent, 1.0, plane.factor());
  drawn.front().legend = source.words.get("plot.drawn");
  std::move(drawn.begin(), drawn.end(), std::back_inserter(plot.curves));
  return plot;
}

}  // namespace

void add_before_after(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  for (const auto* a : m.analyses) {
    const PointTable& p = a->evaluation.points;
    const auto *target = p.column("target"), *before = p.column("before"),
               *after = p.column("after"), *U = p.column("U_predicted");
    if (target == nullptr || before == nullptr || after == nullptr || U == nullptr) continue;
    const Style& style = source.look.style;
    const std::string unit = unit_text(target->quantity);
    Plot plot;
    plot.title = source.words.get("plot.before_after");
    plot.x_title =
        m.measurement.kind == "diagonal"
            ? source.words.get("plot.along", {{"unit", unit}})
            : source.words.get("plot.position", {{"axis", m.measurement.axis}, {"unit", unit}});
    plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(before->quantity)}});
    plot.language = source.language();
    plot.degrees = target->quantity == Quantity::angle;
    plot.empty_text = source.words.get("plot.nothing");
    Curve band =
        curve_of(*target, *U, pale(style.text), Dash::solid, source.words.get("plot.predicted"));
    band.kind = Curve::Kind::band;
    band.width = 0.3;
    for (const double v : band.y) band.y2.push_back(-v);
    plot.curves = {
        std::move(band),
        curve_of(*target, *before, style.minus, Dash::dashed, source.words.get("plot.before")),
        curve_of(*target, *after, style.plus, Dash::solid, source.words.get("plot.after"))};
    plot.curves[1].marker = Marker::down;
    plot.curves[2].marker = Marker::up;
    plots.push_back(std::move(plot));
  }
}

void add_diagonals(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  for (const auto* a : m.analyses)
    if (auto plot = steps_plot(source, *a)) plots.push_back(std::move(*plot));
  for (const auto* a : m.analyses)
    if (const auto d = diagonals_of(*a)) {
      plots.push_back(diagonals_plot(source, *d));
      if (auto plane = plane_plot(source, a->evaluation)) plots.push_back(std::move(*plane));
    }
}

}  // namespace nonio::pages
