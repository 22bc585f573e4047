// SPDX-License-Identifier: Apache-2.0
// Figures of ball centers of a rotary axis: their circle with exaggerated residuals, and the
// residuals over the angle.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;
using Curve = Plot::Curve;

namespace {

struct Centres {
  std::vector<double> angle, radial, axial;
  double radius = 0.0;
};

Centres centres_of(const Measured& m) {
  for (const auto* a : m.analyses) {
    const PointTable& p = a->evaluation.points;
    const auto *angle = p.column("target"), *radial = p.column("radial"),
               *axial = p.column("axial");
    const auto radius = std::find_if(a->evaluation.values.begin(), a->evaluation.values.end(),
                                     [](const Value& v) { return v.name == "radius"; });
    if (angle != nullptr && radial != nullptr && axial != nullptr &&
        radius != a->evaluation.values.end())
      return {angle->values, radial->values, axial->values, radius->value};
  }
  return {};
}

double exaggeration(const Centres& c) {
  double largest = 0.0;
  for (const double r : c.radial) largest = std::max(largest, std::fabs(r));
  if (!(largest > 0.0)) return 1.0;
  const double wanted = 0.25 * c.radius / largest;
  return wanted > 1.0 ? round_factor(wanted) : 1.0;
}

Plot circle(const Source& source, const Centres& c, double height) {
  const Style& style = source.look.style;
  const double factor = exaggeration(c), mm = unit_of(Quantity::length).per_si;
  Plot plot;
  plot.title = source.words.get("plot.circle", {{"factor", fixed_text(factor, 0)}});
  plot.x_title = plot.y_title =
      source.words.get("plot.plane_of_circle", {{"unit", unit_text(Quantity::length)}});
  plot.language = source.language();
  plot.same_scale = true;
  plot.height = height;
  const auto point = [&](double angle, double radius) {
    return std::pair(radius * mm * std::cos(angle), radius * mm * std::sin(angle));
  };
  Curve fitted;
  for (int i = 0; i <= 180; ++i) {
    const auto [x, y] = point(i * std::numbers::pi / 90, c.radius);
    fitted.x.push_back(x), fitted.y.push_back(y);
  }
  fitted.colour = style.muted, fitted.width = 0.7;
  fitted.legend = source.words.get("plot.fitted");
  plot.curves.push_back(std::move(fitted));
  Curve centres;
  for (std::size_t i = 0; i < c.angle.size(); ++i) {
    const auto [x0, y0] = point(c.angle[i], c.radius);
    const auto [x, y] = point(c.angle[i], c.radius + factor * c.radial[i]);
    Curve arm;
    arm.x = {x0, x}, arm.y = {y0, y};
    arm.colour = style.plus, arm.width = 1.1;
    plot.curves.push_back(std::move(arm));
    centres.x.push_back(x), centres.y.push_back(y);
  }
  centres.colour = style.plus, centres.width = 0.0;
  centres.marker = Marker::dot;
  centres.legend = source.words.get("plot.centre");
  plot.curves.push_back(std::move(centres));
  return plot;
}

Plot residuals(const Source& source, const Measured& m, const Centres& c, double height) {
  const Style& style = source.look.style;
  const double um = unit_of(Quantity::deviation).per_si;
  Plot plot;
  plot.title = source.words.get("plot.residuals");
  plot.x_title = source.words.get(
      "plot.position", {{"axis", m.measurement.axis}, {"unit", unit_text(Quantity::angle)}});
  plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(Quantity::deviation)}});
  plot.language = source.language();
  plot.degrees = true;
  plot.height = height;
  for (const bool radial : {true, false}) {
    Curve curve;
    const auto& values = radial ? c.radial : c.axial;
    for (std::size_t i = 0; i < c.angle.size(); ++i) {
      curve.x.push_back(c.angle[i] * deg_per_rad);
      curve.y.push_back(values[i] * um);
    }
    curve.colour = radial ? style.plus : style.minus;
    curve.dash = radial ? Dash::solid : Dash::dashed;
    curve.marker = radial ? Marker::dot : Marker::ring;
    curve.width = 1.0;
    curve.legend = source.words.get(radial ? "plot.radial" : "plot.axial");
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

Plot chain_residuals(const Source& source, const PointTable& p, const std::string& axis,
                     double height) {
  const Style& style = source.look.style;
  Plot plot;
  plot.title = source.words.get("plot.chain_residuals", {{"axis", axis}});
  plot.x_title =
      source.words.get("plot.position", {{"axis", axis}, {"unit", unit_text(Quantity::angle)}});
  plot.y_title = source.words.get("plot.deviation", {{"unit", unit_text(Quantity::deviation)}});
  plot.language = source.language();
  plot.degrees = true;
  plot.height = height;
  const double um = unit_of(Quantity::deviation).per_si;
  const std::array colours{style.plus, style.minus, style.good};
  static constexpr std::array markers{Marker::dot, Marker::ring, Marker::up};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto* residual = p.column(std::string("residual_") + "xyz"[k]);
    if (residual == nullptr) continue;
    Curve curve;
    for (std::size_t i = 0; i < residual->values.size(); ++i) {
      curve.x.push_back(p.column(axis)->values[i] * deg_per_rad);
      curve.y.push_back(residual->values[i] * um);
    }
    curve.colour = colours[k], curve.marker = markers[k];
    curve.width = 0.0;
    curve.legend = std::string(1, "XYZ"[k]);
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

}  // namespace

void add_chain(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  for (const auto* a : m.analyses) {
    const PointTable& p = a->evaluation.points;
    if (p.column("residual_x") == nullptr) continue;
    for (const PointTable::Column& column : p.columns)
      if (column.quantity == Quantity::angle)
        plots.push_back(
            chain_residuals(source, p, column.name, 1.2 * source.look.style.plot_height));
  }
}

void add_circle(const Source& source, const Measured& m, std::vector<Plot>& plots) {
  const Centres c = centres_of(m);
  if (c.angle.empty()) return;
  const double height = 1.5 * source.look.style.plot_height;
  plots.push_back(circle(source, c, height));
  plots.push_back(residuals(source, m, c, height));
}

}  // namespace nonio::pages
