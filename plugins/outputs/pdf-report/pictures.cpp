// SPDX-License-Identifier: Apache-2.0
// Readings with their model, and the page of residuals. Its nine figures always have the same
// positions, so that readers find them. A figure without data states this in its frame.
#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/reports/residuals.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;
using Curve = Plot::Curve;

namespace {

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

Colour pale(Colour c) { return {(1 + c.red) / 2, (1 + c.green) / 2, (1 + c.blue) / 2}; }

class Pictures {
 public:
  Pictures(const Source& source, const ModelFit& fit)
      : source_(source),
        words_(source.pictures),
        fit_(fit),
        style_(source.look.style),
        deviation_(deviation_of(fit.angular)),
        scale_(place_scale(fit)),
        per_si_(unit_of(deviation_).per_si),
        suspect_(fit.size(), 0),
        lanes_(lanes_of(fit)) {
    for (const ModelFit::Suspect& s : fit.suspects)
      if (s.row < fit.size()) suspect_[s.row] = 1;
    double low = 0, high = 0;
    const auto widen = [&](double v) {
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    };
    for (const auto* values : {&fit.residual, &fit.cv_residual})
      for (std::size_t i = 0; i < std::min(values->size(), fit.size()); ++i)
        if (suspect_[i] == 0) widen((*values)[i]);
    if (fit.floor) widen(2.2 * *fit.floor), widen(-2.2 * *fit.floor);
    const double edge = 0.06 * (high - low);
    range_ = {(low - edge) * per_si_, (high + edge) * per_si_};
  }

  Plot draw(ResidualPlot picture, const PictureWords& said) const {
    Plot plot = frame(said);
    if (!said.none.empty()) return plot;
    switch (picture) {
      case ResidualPlot::position:
        position(plot);
        break;
      case ResidualPlot::reversal:
        reversal(plot);
        break;
      case ResidualPlot::time:
        time(plot, said.x_per_si);
        break;
      case ResidualPlot::run:
        run(plot);
        break;
      case ResidualPlot::phase:
        residuals(plot, phase_of(fit_, period_of(fit_)), said.x_per_si);
        break;
      case ResidualPlot::temperature:
        residuals(plot, fit_.temperature, said.x_per_si);
        break;
      case ResidualPlot::predicted:
        predicted(plot);
        break;
      case ResidualPlot::normal:
        normal(plot);
        break;
      case ResidualPlot::left_out:
        plot.lanes = lanes_.names;
        scatter(plot, places(), scaled(fit_.cv_residual, per_si_));
        break;
    }
    return plot;
  }

  std::array<Plot, 2> with_model(const PictureWords& said, const PictureWords& left) const {
    Plot above = frame(said), below = frame(left);
    below.title.clear();
    below.empty_text = said.none;
    if (said.none.empty()) {
      above.range.reset();
      above.belts.clear();
      above.lanes = lanes_.names;
      readings(above);
      position(below);
    }
    above.x_title.clear();
    for (Plot* plot : {&above, &below}) plot->number_room = 26;
    above.height = 1.15 * style_.plot_height;
    below.height = 0.75 * style_.plot_height;
    return {std::move(above), std::move(below)};
  }

  /// Temperatures, speeds and loads during the readings, one plot per unit. Channels in the model
  /// have a legend; the others are thin lines.
  std::vector<Plot> channels(const PictureWords& said) const {
    std::vector<Plot> out;
    std::vector<std::string> units;
    for (const ModelFit::Channel& c : fit_.channels)
      if (std::find(units.begin(), units.end(), c.unit) == units.end()) units.push_back(c.unit);
    for (const std::string& unit : units) {
      Plot plot = frame(said);
      plot.title.clear(), plot.range.reset(), plot.belts.clear(), plot.x_title.clear();
      plot.y_title = unit == "degC" ? "°C" : unit;
      plot.zero_line = false;
      plot.number_room = 26;
      plot.height = 0.6 * style_.plot_height;
      std::size_t number = 0;
      for (const bool used : {false, true})
        for (const ModelFit::Channel& c : fit_.channels)
          if (c.unit == unit && c.used == used) channel(plot, c, used ? number++ : 0);
      out.push_back(std::move(plot));
    }
    if (!out.empty()) out.back().x_title = said.x;
    return out;
  }

  std::string legend() const { return words_.get("picture.legend") + " " + marks(); }

  std::string marks() const {
    std::string text =
        fit_.floor
            ? words_.get("picture.legend_floor",
                         {{"s", printed_number(*fit_.floor, deviation_, 2, source_.language())},
                          {"unit", unit_text(deviation_)}})
            : words_.get("picture.no_floor");
    if (!fit_.suspects.empty())
      text += " " + words_.get("picture.legend_suspect",
                               {{"count", std::to_string(fit_.suspects.size())}});
    return text;
  }

 private:
  void channel(Plot& plot, const ModelFit::Channel& c, std::size_t number) const {
    constexpr std::size_t most_points = 1500;
    constexpr Dash dashes[] = {Dash::solid, Dash::dashed, Dash::dash_dot, Dash::dotted};
    const Colour colours[] = {style_.text, style_.accent, style_.minus, style_.plus};
    Curve line;
    const std::size_t step = c.values.size() / most_points + 1;
    for (std::size_t i = 0; i < c.values.size(); i += step)
      line.x.push_back(fit_.target[i] * scale_.per_si), line.y.push_back(c.values[i]);
    line.colour = c.used ? colours[number % std::size(colours)] : style_.muted;
    line.dash = dashes[number % std::size(dashes)];
    line.width = c.used ? 1.1 : 0.4;
    if (c.used) line.legend = c.name;
    plot.curves.push_back(std::move(line));
  }

  Plot frame(const PictureWords& said) const {
    Plot plot;
    plot.title = said.title;
    plot.x_title = said.x;
    plot.y_title = said.y;
    plot.degrees = said.degrees;
    plot.language = source_.language();
    plot.empty_text = said.none;
    plot.range = range_;
    if (fit_.floor) {
      const double half = 2 * *fit_.floor * per_si_;
      plot.belts.push_back({-half, half, style_.rule});
    }
    return plot;
  }

  double held(double y) const {
    const double inset = 0.03 * (range_.second - range_.first);
    return std::clamp(y, range_.first + inset, range_.second - inset);
  }

  /// Readings by direction, in printed units. `row` is the index of the reading of each point; if
  /// it is empty, point i is reading i.
  void scatter(Plot& plot, const std::vector<double>& x, const std::vector<double>& y,
               const std::vector<std::size_t>& row = {}) const {
    Curve plus, minus, other;
    plus.colour = style_.plus, plus.marker = Marker::up;
    minus.colour = style_.minus, minus.marker = Marker::down;
    other.colour = style_.accent, other.marker = Marker::dot;
    Curve marks;
    marks.colour = style_.failed, marks.marker = Marker::around;
    for (std::size_t i = 0; i < x.size() && i < y.size(); ++i) {
      const std::size_t r = row.empty() ? i : row[i];
      const int d = r < fit_.direction.size() ? fit_.direction[r] : 0;
      const bool suspect = suspect_[r] != 0;
      const double v = suspect ? held(y[i]) : y[i];
      for (Curve* c : {d > 0 ? &plus : d < 0 ? &minus : &other, suspect ? &marks : nullptr})
        if (c != nullptr) c->x.push_back(x[i]), c->y.push_back(v);
    }
    for (Curve* c : {&plus, &minus, &other, &marks}) {
      c->kind = Curve::Kind::points;
      c->marker_size = c == &marks ? 3.6 : 1.5;
      if (!c->x.empty()) plot.curves.push_back(std::move(*c));
    }
  }

  void line(Plot& plot, std::vector<double> x, std::vector<double> y, Colour colour,
            Dash dash = Dash::solid) const {
    Curve c;
    c.x = std::move(x), c.y = std::move(y);
    c.colour = colour, c.dash = dash, c.width = 1.2;
    if (c.x.size() > 1) plot.curves.push_back(std::move(c));
  }

  void residuals(Plot& plot, const std::vector<double>& x, double per_si) const {
    scatter(plot, scaled(x, per_si), scaled(fit_.residual, per_si_));
    const Trace mean = mean_by_part(fit_, x);
    line(plot, scaled(mean.x, per_si), scaled(mean.y, per_si_), style_.text);
  }

  std::vector<double> along(std::vector<double> targets, std::size_t measurement) const {
    for (double& t : targets)
      t = lanes_.names.empty() ? (t - scale_.from) * scale_.per_si : lanes_.at(measurement, t);
    return targets;
  }

  std::vector<double> places() const {
    if (lanes_.names.empty()) return along(fit_.target, 0);
    std::vector<double> out(fit_.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = lanes_.at(fit_.measurement[i], fit_.target[i]);
    return out;
  }

  void position(Plot& plot) const {
    plot.lanes = lanes_.names;
    scatter(plot, places(), scaled(fit_.residual, per_si_));
    for (std::uint32_t m = 0; m < std::max<std::size_t>(fit_.measurements.size(), 1); ++m)
      mean_lines(plot, fit_.measurements.size() > 1 ? of_measurement(fit_, m) : fit_, m);
  }

  void readings(Plot& plot) const {
    constexpr std::size_t most_lines = 60;  // with more passes, lines would overlap too much
    constexpr std::size_t most_single = 5000;
    const std::vector<double> x = places(), y = scaled(fit_.deviation, per_si_);
    std::vector<double> model(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) model[i] = y[i] - fit_.residual[i] * per_si_;
    const auto passes = passes_of(fit_);
    const auto of = [](const std::vector<std::size_t>& rows, const std::vector<double>& values) {
      std::vector<double> out;
      for (const std::size_t i : rows) out.push_back(values[i]);
      return out;
    };
    if (passes.size() <= most_lines)
      for (const Pass& pass : passes)
        if (pass.is_path) {
          line(plot, of(pass.rows, x), of(pass.rows, y),
               pale(pass.direction > 0   ? style_.plus
                    : pass.direction < 0 ? style_.minus
                                         : style_.accent));
          if (!plot.curves.empty()) plot.curves.back().width = 0.4;
        }
    scatter(plot, x, y);
    if (fit_.size() > most_single) return mean_model(plot);
    for (const Pass& pass : passes) {
      if (pass.is_path) {
        line(plot, of(pass.rows, x), of(pass.rows, model), style_.text,
             pass.direction < 0 ? Dash::dashed : Dash::solid);
        continue;
      }
      Curve points;
      points.kind = Curve::Kind::points;
      points.x = of(pass.rows, x), points.y = of(pass.rows, model);
      points.colour = style_.text, points.marker = Marker::dot, points.marker_size = 0.8;
      plot.curves.push_back(std::move(points));
    }
  }

  void mean_model(Plot& plot) const {
    ModelFit model = fit_;
    for (std::size_t i = 0; i < model.size(); ++i)
      model.residual[i] = fit_.deviation[i] - fit_.residual[i];
    for (std::uint32_t m = 0; m < std::max<std::size_t>(fit_.measurements.size(), 1); ++m) {
      const ModelFit of = fit_.measurements.size() > 1 ? of_measurement(model, m) : model;
      for (const int d : {+1, -1, 0}) {
        const Trace mean = mean_by_target(of, d);
        line(plot, along(mean.x, m), scaled(mean.y, per_si_), style_.text,
             d < 0 ? Dash::dashed : Dash::solid);
      }
    }
  }

  void mean_lines(Plot& plot, const ModelFit& fit, std::size_t measurement) const {
    for (const int d : {+1, -1, 0}) {
      const Trace mean = mean_by_target(fit, d);
      line(plot, along(mean.x, measurement), scaled(mean.y, per_si_),
           d > 0   ? style_.plus
           : d < 0 ? style_.minus
                   : style_.accent,
           d < 0 ? Dash::dashed : Dash::solid);
    }
  }

  void reversal(Plot& plot) const {
    plot.range.reset();
    plot.belts.clear();
    plot.lanes = lanes_.names;
    if (fit_.measurements.size() <= 1) return reversal_line(plot, reversal_of(fit_), 0, true);
    double widest = 0;
    for (std::uint32_t m = 0; m < fit_.measurements.size(); ++m) {
      const Reversal r = reversal_of(of_measurement(fit_, m));
      for (const double spread : r.spread) widest = std::max(widest, spread);
      if (!r.values.x.empty()) reversal_line(plot, r, m, false);
    }
    // One belt for all lines, because overlapping bands would become darker.
    const double half = fit_.floor ? 2 * widest * *fit_.floor * per_si_ : 0;
    if (half > 0) plot.belts.push_back({-half, half, style_.rule});
  }

  void reversal_line(Plot& plot, const Reversal& r, std::size_t measurement, bool with_band) const {
    const auto x = along(r.values.x, measurement);
    if (with_band && fit_.floor) {
      Curve band;
      band.kind = Curve::Kind::band;
      band.x = x;
      band.y = scaled(r.spread, 2 * *fit_.floor * per_si_);
      band.y2 = scaled(r.spread, -2 * *fit_.floor * per_si_);
      band.colour = style_.muted;
      band.width = 0;
      plot.curves.push_back(std::move(band));
    }
    Curve values;
    values.x = x;
    values.y = scaled(r.values.y, per_si_);
    values.colour = style_.accent;
    plot.curves.push_back(values);
    values.kind = Curve::Kind::points;
    values.marker = Marker::dot;
    values.marker_size = 1.6;
    plot.curves.push_back(std::move(values));
  }

  void time(Plot& plot, double per_si) const {
    std::vector<double> t = fit_.time;
    double first = INFINITY;
    for (const double v : t)
      if (std::isfinite(v)) first = std::min(first, v);
    for (double& v : t) v -= first;
    residuals(plot, t, per_si);
  }

  void run(Plot& plot) const {
    plot.whole = true;
    scatter(plot, {fit_.run.begin(), fit_.run.end()}, scaled(fit_.residual, per_si_));
    const Trace mean = mean_by_run(fit_);
    line(plot, mean.x, scaled(mean.y, per_si_), style_.text);
  }

  void predicted(Plot& plot) const {
    std::vector<double> x = fit_.deviation;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= fit_.residual[i];
    residuals(plot, x, per_si_);
  }

  void normal(Plot& plot) const {
    const Normal n = normal_plot(fit_);
    scatter(plot, n.values.x, scaled(n.values.y, per_si_), n.row);
    if (!fit_.floor) return;
    const double low = n.values.x.front(), high = n.values.x.back(), s = *fit_.floor * per_si_;
    line(plot, {low, high}, {low * s, high * s}, style_.text, Dash::dashed);
  }

  const Source& source_;
  const Wording& words_;
  const ModelFit& fit_;
  const Style& style_;
  Quantity deviation_;
  PlaceScale scale_;
  double per_si_;
  std::vector<char> suspect_;
  Lanes lanes_;
  std::pair<double, double> range_;
};

}  // namespace

void add_fit(const Source& source, const ModelFit& fit, Blocks& blocks) {
  const std::string field = "readings and model of " + fit.part;
  const Pictures pictures(source, fit);
  const auto said = picture_words(fit, source.pictures);
  const PictureWords words = fit_words(fit, source.pictures);
  auto [above, below] = pictures.with_model(words, said.front());
  const std::string legend = words.says + " " + pictures.marks();
  std::vector<Plot> recorded = pictures.channels(said.front());
  if (!recorded.empty()) below.x_title.clear();
  Columns together;
  auto& parts = together.parts.emplace_back();
  parts.push_back({std::move(above), field});
  parts.push_back({std::move(below), field});
  for (Plot& plot : recorded) parts.push_back({std::move(plot), field});
  parts.push_back({Paragraph{legend, Paragraph::Look::muted}, field});
  blocks.push_back({Spacer{4}});
  blocks.push_back({std::move(together), field});
}

void add_pictures(const Source& source, const ModelFit& fit, Blocks& blocks) {
  constexpr std::size_t per_row = 3;
  const Style& style = source.look.style;
  const std::string field = "pictures of the model of " + fit.part;
  const Pictures pictures(source, fit);
  blocks.push_back({PageBreak{}});
  blocks.push_back(
      {Heading{source.pictures.get("picture.heading", {{"part", fit.part}}), 1}, field});
  blocks.push_back({Paragraph{pictures.legend(), Paragraph::Look::small}, field});
  // Heading, legend, captions of up to three lines and gaps reduce the height of the plots.
  constexpr double between = 7;
  const double heading = 9 + 1.3 * style.heading + 6, legend = 3 * 1.3 * style.small + 2;
  const double around = 5 + 3 * 1.3 * style.small + 2 + between;
  const double end = 1.3 * style.small + 2;
  const double height = (page_room(style) - heading - legend - end) / 3 - around;
  const auto said = picture_words(fit, source.pictures);
  for (std::size_t i = 0; i < said.size(); i += per_row) {
    Columns row;
    for (std::size_t k = i; k < i + per_row; ++k) {
      Plot plot = pictures.draw(static_cast<ResidualPlot>(k), said[k]);
      plot.height = height;
      row.parts.push_back(
          {{std::move(plot), field}, {Paragraph{said[k].says, Paragraph::Look::muted}, field}});
    }
    blocks.push_back({std::move(row), field});
    blocks.push_back({Spacer{between}});
  }
}

}  // namespace nonio::pdf_report
