// SPDX-License-Identifier: Apache-2.0
//
// The page of residuals. Its nine pictures have the same places whatever the data are, so that the
// eye learns where to look; one whose data are not there says so in its frame.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "picture_data.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;
using Curve = Plot::Curve;

namespace {

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

class Pictures {
 public:
  Pictures(const Source& source, const ModelFit& fit)
      : source_(source),
        words_(source.pictures),
        fit_(fit),
        style_(source.look.style),
        deviation_(deviation_of(fit.angular)),
        position_(position_of(fit.rotary)),
        per_si_(unit_of(deviation_).per_si),
        suspect_(fit.size(), 0) {
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

  std::array<Plot, 9> all() const {
    return {position(),    reversal(),  time(),   run(),     phase(),
            temperature(), predicted(), normal(), left_out()};
  }

  std::string legend() const {
    std::string text = words_.get("picture.legend");
    text += " " + (fit_.floor
                       ? words_.get(
                             "picture.legend_floor",
                             {{"s", printed_number(*fit_.floor, deviation_, 2, source_.language())},
                              {"unit", unit_text(deviation_)}})
                       : words_.get("picture.no_floor"));
    if (!fit_.suspects.empty())
      text += " " + words_.get("picture.legend_suspect",
                               {{"count", std::to_string(fit_.suspects.size())}});
    return text;
  }

 private:
  /// A frame with its words; `over` is the title of the horizontal axis.
  Plot frame(const std::string& name, std::string over) const {
    Plot plot;
    plot.title = words_.get("picture." + name + ".title");
    plot.x_title = std::move(over);
    plot.y_title = words_.get("picture.residual", {{"unit", unit_text(deviation_)}});
    plot.language = source_.language();
    plot.empty_text = words_.get("picture.no_readings");
    plot.range = range_;
    if (fit_.floor) {
      const double half = 2 * *fit_.floor * per_si_;
      plot.belts.push_back({-half, half, style_.rule});
    }
    return plot;
  }

  std::string along() const {
    return source_.words.get("plot.position",
                             {{"axis", fit_.axis}, {"unit", unit_text(position_)}});
  }

  /// Nothing but the reason why.
  static Plot without(Plot plot, std::string why) {
    plot.curves.clear();
    plot.empty_text = std::move(why);
    return plot;
  }

  double held(double y) const {  // suspects beyond the picture stand at its edge
    const double inset = 0.03 * (range_.second - range_.first);
    return std::clamp(y, range_.first + inset, range_.second - inset);
  }

  /// Readings by direction, in printed units; `row`: which reading a point is, if not the i-th.
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

  /// Residuals over x (SI), with their mean along it.
  void residuals(Plot& plot, const std::vector<double>& x, double per_si) const {
    scatter(plot, scaled(x, per_si), scaled(fit_.residual, per_si_));
    const Trace mean = mean_by_part(fit_, x);
    line(plot, scaled(mean.x, per_si), scaled(mean.y, per_si_), style_.text);
  }

  Plot position() const {
    Plot plot = frame("position", along());
    plot.degrees = fit_.rotary;
    const double across = unit_of(position_).per_si;
    scatter(plot, scaled(fit_.target, across), scaled(fit_.residual, per_si_));
    for (const int d : {+1, -1, 0}) {
      const Trace mean = mean_by_target(fit_, d);
      line(plot, scaled(mean.x, across), scaled(mean.y, per_si_),
           d > 0   ? style_.plus
           : d < 0 ? style_.minus
                   : style_.accent,
           d < 0 ? Dash::dashed : Dash::solid);
    }
    return plot;
  }

  Plot reversal() const {
    Plot plot = frame("reversal", along());
    plot.y_title = words_.get("picture.reversal.y", {{"unit", unit_text(deviation_)}});
    plot.degrees = fit_.rotary;
    plot.range.reset();
    plot.belts.clear();
    const Reversal r = reversal_of(fit_);
    if (r.values.x.empty()) return without(std::move(plot), words_.get("picture.reversal.none"));
    const auto x = scaled(r.values.x, unit_of(position_).per_si);
    if (fit_.floor) {
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
    values.marker = Marker::dot;
    values.marker_size = 1.8;
    plot.curves.push_back(std::move(values));
    return plot;
  }

  Plot time() const {
    double first = INFINITY, last = -INFINITY;
    for (const double t : fit_.time)
      if (std::isfinite(t)) first = std::min(first, t), last = std::max(last, t);
    const double span = last - first;
    const auto [unit, per_si] = span > 7200  ? std::pair("h", 1.0 / 3600)
                                : span > 300 ? std::pair("min", 1.0 / 60)
                                             : std::pair("s", 1.0);
    Plot plot = frame("time", words_.get("picture.time.x", {{"unit", unit}}));
    if (!(first <= last)) return without(std::move(plot), words_.get("picture.time.none"));
    std::vector<double> t = fit_.time;
    for (double& v : t) v -= first;
    residuals(plot, t, per_si);
    return plot;
  }

  Plot run() const {
    Plot plot = frame("run", words_.get("picture.run.x"));
    plot.whole = true;
    if (fit_.run.empty()) return without(std::move(plot), words_.get("picture.run.none"));
    scatter(plot, {fit_.run.begin(), fit_.run.end()}, scaled(fit_.residual, per_si_));
    const Trace mean = mean_by_run(fit_);
    line(plot, mean.x, scaled(mean.y, per_si_), style_.text);
    return plot;
  }

  Plot phase() const {
    const bool turn = fit_.rotary && !fit_.period;
    const std::string name = !fit_.rotary ? "phase" : turn ? "angle" : "mesh";
    Plot plot = frame(name, words_.get("picture." + name + ".x", {{"unit", unit_text(position_)}}));
    plot.degrees = turn;
    if (!turn && !(fit_.period && *fit_.period > 0))
      return without(std::move(plot), words_.get("picture.phase.none"));
    const double period = turn ? 2 * std::numbers::pi : *fit_.period;
    const auto x = phase_of(fit_, period);
    if (one_phase(x, period))
      return without(
          std::move(plot),
          words_.get("picture.phase.one", {{"period", plain_number(source_, period, position_)},
                                           {"unit", unit_text(position_)}}));
    residuals(plot, x, unit_of(position_).per_si);
    return plot;
  }

  Plot temperature() const {
    Plot plot = frame("temperature", words_.get("picture.temperature.x"));
    if (!any_finite(fit_.temperature))
      return without(std::move(plot), words_.get("picture.temperature.none"));
    residuals(plot, fit_.temperature, 1.0);
    return plot;
  }

  Plot predicted() const {
    Plot plot =
        frame("predicted", words_.get("picture.predicted.x", {{"unit", unit_text(deviation_)}}));
    std::vector<double> x = fit_.deviation;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= fit_.residual[i];
    residuals(plot, x, per_si_);
    return plot;
  }

  Plot normal() const {
    Plot plot = frame("normal", words_.get("picture.normal.x"));
    const Normal n = normal_plot(fit_);
    scatter(plot, n.values.x, scaled(n.values.y, per_si_), n.row);
    if (fit_.floor && !n.values.x.empty()) {
      const double low = n.values.x.front(), high = n.values.x.back(), s = *fit_.floor * per_si_;
      line(plot, {low, high}, {low * s, high * s}, style_.text, Dash::dashed);
    }
    return plot;
  }

  Plot left_out() const {
    Plot plot = frame("left-out", along());
    plot.y_title = words_.get("picture.left-out.y", {{"unit", unit_text(deviation_)}});
    plot.degrees = fit_.rotary;
    if (!any_finite(fit_.cv_residual))
      return without(std::move(plot), words_.get("picture.left-out.none"));
    scatter(plot, scaled(fit_.target, unit_of(position_).per_si),
            scaled(fit_.cv_residual, per_si_));
    return plot;
  }

  const Source& source_;
  const Wording& words_;
  const ModelFit& fit_;
  const Style& style_;
  Quantity deviation_, position_;
  double per_si_;
  std::vector<char> suspect_;  ///< of each reading
  std::pair<double, double> range_;
};

}  // namespace

void add_pictures(const Source& source, const ModelFit& fit, Blocks& blocks) {
  constexpr std::size_t per_row = 3;
  const Style& style = source.look.style;
  const std::string field = "pictures of the model of " + fit.part;
  const Pictures pictures(source, fit);
  blocks.push_back({PageBreak{}});
  blocks.push_back(
      {Heading{source.pictures.get("picture.heading", {{"part", fit.part}}), 1}, field});
  blocks.push_back({Paragraph{pictures.legend(), Paragraph::Look::small}, field});
  // What heading, legend and captions of up to four lines need is not there for the plots.
  const double captions = 3 * (4 * 1.3 * style.small + 7);
  const double height =
      (page_room(style) - 2 * style.heading - 18 - 4 * style.small - captions) / 3;
  constexpr std::array names = {"position",    "reversal",  "time",   "run",     "phase",
                                "temperature", "predicted", "normal", "left-out"};
  auto plots = pictures.all();
  for (std::size_t i = 0; i < plots.size(); i += per_row) {
    Columns row;
    for (std::size_t k = i; k < i + per_row; ++k) {
      plots[k].height = height;
      const bool turn = std::string_view(names[k]) == "phase" && fit.rotary;
      const std::string says = std::string("picture.") + (turn ? "angle" : names[k]) + ".says";
      row.parts.push_back({{std::move(plots[k]), field},
                           {Paragraph{source.pictures.get(says), Paragraph::Look::muted}, field}});
    }
    blocks.push_back({std::move(row), field});
  }
}

}  // namespace nonio::pdf_report
