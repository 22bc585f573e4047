// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/residuals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "nonio/reports/number.h"

namespace nonio::reports {
namespace {

struct Mean {
  double sum = 0.0;
  std::size_t n = 0;
  void add(double v) { sum += v, ++n; }
  double value() const { return sum / static_cast<double>(n); }
};

/// z with Phi(z) = p: Newton's method for Phi(z) = erfc(-z/sqrt 2)/2 from 0, which converges
/// monotonically because of the curvature of Phi.
double normal_quantile(double p) {
  double z = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    const double step = (std::erfc(-z / std::numbers::sqrt2) / 2 - p) / density;
    z -= step;
    if (std::fabs(step) < 1e-12) break;
  }
  return z;
}

/// Whether all phases are within +-1 % of the period, so that no pattern is visible.
bool one_phase(const std::vector<double>& phase, double period) {
  double sine = 0, cosine = 0;
  for (const double p : phase) {
    sine += std::sin(2 * std::numbers::pi * p / period);
    cosine += std::cos(2 * std::numbers::pi * p / period);
  }
  const double middle = std::atan2(sine, cosine) / (2 * std::numbers::pi);
  return std::all_of(phase.begin(), phase.end(), [&](double p) {
    return std::fabs(std::remainder(p / period - middle, 1.0)) <= 0.01;
  });
}

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool both_directions(const ModelFit& fit) { return !reversal_of(fit).values.x.empty(); }

std::pair<const char*, double> time_unit(const ModelFit& fit) {
  double first = INFINITY, last = -INFINITY;
  for (const double t : fit.time)
    if (std::isfinite(t)) first = std::min(first, t), last = std::max(last, t);
  const double span = last - first;
  return span > 7200  ? std::pair("h", 3600.0)
         : span > 300 ? std::pair("min", 60.0)
                      : std::pair("s", 1.0);
}

std::string no_phase(const ModelFit& fit, const Wording& words) {
  const double period = period_of(fit);
  const Quantity q = position_of(fit.rotary);
  if (!(period > 0)) return words.get(fit.period ? "picture.phase.several" : "picture.phase.none");
  if (!one_phase(phase_of(fit, period), period)) return {};
  return words.get(
      "picture.phase.one",
      {{"period", printed_number(period, q, decimals_for({period}, q, 4), words.language())},
       {"unit", unit_text(q)}});
}

int direction_of(const ModelFit& fit, std::size_t row) {
  return row < fit.direction.size() ? fit.direction[row] : 0;
}

}  // namespace

bool counts(const ModelFit& fit, std::size_t row) {
  return row >= fit.weight.size() || fit.weight[row] >= 0.5;
}

Trace mean_by_target(const ModelFit& fit, int direction) {
  std::map<double, Mean> means;
  for (std::size_t i = 0; i < fit.size(); ++i)
    if (direction_of(fit, i) == direction && counts(fit, i))
      means[fit.target[i]].add(fit.residual[i]);
  Trace out;
  for (const auto& [target, mean] : means) out.x.push_back(target), out.y.push_back(mean.value());
  return out;
}

ModelFit of_measurement(const ModelFit& fit, std::uint32_t measurement) {
  ModelFit out;
  for (std::size_t i = 0; i < fit.size(); ++i) {
    if (i >= fit.measurement.size() || fit.measurement[i] != measurement) continue;
    out.target.push_back(fit.target[i]);
    out.direction.push_back(static_cast<std::int8_t>(direction_of(fit, i)));
    out.deviation.push_back(fit.deviation[i]);
    out.residual.push_back(fit.residual[i]);
    out.weight.push_back(i < fit.weight.size() ? fit.weight[i] : 1.0);
  }
  return out;
}

bool over_time(const ModelFit& fit) { return fit.size() > 0 && fit.target == fit.time; }

PlaceScale place_scale(const ModelFit& fit) {
  if (!over_time(fit)) {
    const Quantity along = position_of(fit.rotary);
    return {0.0, unit_of(along).per_si, std::string(unit_text(along))};
  }
  const auto [unit, seconds] = time_unit(fit);
  return {*std::min_element(fit.time.begin(), fit.time.end()), 1.0 / seconds, unit};
}

bool in_space(const ModelFit& fit) {
  return std::count_if(fit.axis.begin(), fit.axis.end(),
                       [](char c) { return c == 'X' || c == 'Y' || c == 'Z'; }) > 1;
}

double Lanes::at(std::size_t line, double place) const {
  constexpr double room = 0.08;
  const auto [low, high] = ends[line];
  const double part = low < high ? (place - low) / (high - low) : 0.5;
  return static_cast<double>(line) + room + (1.0 - 2.0 * room) * part;
}

Lanes lanes_of(const ModelFit& fit) {
  Lanes lanes;
  if (!in_space(fit) || fit.measurements.size() < 2) return lanes;
  lanes.names = fit.measurements;
  lanes.ends.assign(lanes.names.size(), {INFINITY, -INFINITY});
  for (std::size_t i = 0; i < fit.size() && i < fit.measurement.size(); ++i) {
    auto& [low, high] = lanes.ends[fit.measurement[i]];
    low = std::min(low, fit.target[i]);
    high = std::max(high, fit.target[i]);
  }
  return lanes;
}

Trace mean_by_run(const ModelFit& fit) {
  std::map<std::uint32_t, Mean> means;
  for (std::size_t i = 0; i < fit.size() && i < fit.run.size(); ++i)
    if (counts(fit, i)) means[fit.run[i]].add(fit.residual[i]);
  Trace out;
  for (const auto& [run, mean] : means) out.x.push_back(run), out.y.push_back(mean.value());
  return out;
}

Trace mean_by_part(const ModelFit& fit, const std::vector<double>& x) {
  double low = INFINITY, high = -INFINITY;
  std::size_t n = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && counts(fit, i))
      low = std::min(low, x[i]), high = std::max(high, x[i]), ++n;
  if (!(low < high) || n < 12) return {};
  const auto parts = std::min<std::size_t>(12, n / 6);
  std::vector<Mean> across(parts), up(parts);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !counts(fit, i)) continue;
    const auto k = std::min(parts - 1, static_cast<std::size_t>((x[i] - low) / (high - low) *
                                                                static_cast<double>(parts)));
    across[k].add(x[i]);
    up[k].add(fit.residual[i]);
  }
  Trace out;
  for (std::size_t k = 0; k < parts; ++k)
    if (up[k].n >= 3) out.x.push_back(across[k].value()), out.y.push_back(up[k].value());
  return out;
}

Reversal reversal_of(const ModelFit& fit) {
  std::map<double, std::pair<Mean, Mean>> targets;
  for (std::size_t i = 0; i < fit.size(); ++i) {
    if (!counts(fit, i)) continue;
    auto& [plus, minus] = targets[fit.target[i]];
    if (direction_of(fit, i) > 0) plus.add(fit.residual[i]);
    if (direction_of(fit, i) < 0) minus.add(fit.residual[i]);
  }
  Reversal out;
  for (const auto& [target, means] : targets) {
    const auto& [plus, minus] = means;
    if (plus.n == 0 || minus.n == 0) continue;
    out.values.x.push_back(target);
    out.values.y.push_back(plus.value() - minus.value());
    out.spread.push_back(
        std::sqrt(1.0 / static_cast<double>(plus.n) + 1.0 / static_cast<double>(minus.n)));
  }
  return out;
}

std::vector<double> phase_of(const ModelFit& fit, double period) {
  std::vector<double> out;
  out.reserve(fit.size());
  for (const double p : fit.target) {
    double phase = p - period * std::floor(p / period);
    if (period - phase < 1e-9 * period) phase = 0.0;  // a multiple of the period, up to rounding
    out.push_back(phase);
  }
  return out;
}

double period_of(const ModelFit& fit) {
  if (fit.period && *fit.period > 0) return *fit.period;
  return fit.rotary ? 2 * std::numbers::pi : 0.0;
}

std::array<PictureWords, 9> picture_words(const ModelFit& fit, const Wording& words) {
  const Quantity across = position_of(fit.rotary), up = deviation_of(fit.angular);
  const bool turn = fit.rotary && !fit.period;
  const std::string phase = !fit.rotary ? "phase" : turn ? "angle" : "mesh";
  const auto [time, seconds] = time_unit(fit);
  const std::array<std::string, 9> names = {"position",    "reversal",  "time",   "run",     phase,
                                            "temperature", "predicted", "normal", "left-out"};
  std::array<PictureWords, 9> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::string key = "picture." + names[i] + ".";
    const auto picture = static_cast<ResidualPlot>(i);
    const bool along = picture == ResidualPlot::position || picture == ResidualPlot::reversal ||
                       picture == ResidualPlot::left_out;
    const bool own_y = picture == ResidualPlot::reversal || picture == ResidualPlot::left_out;
    const char* unit = picture == ResidualPlot::time ? time : nullptr;
    const Quantity q = picture == ResidualPlot::predicted ? up : across;
    PictureWords& w = out[i];
    w.title = words.get(key + "title");
    w.says = words.get((names[i] == "mesh" ? "picture.angle." : key) + "says");
    if (along && over_time(fit)) unit = time;
    w.x = words.get(along ? (over_time(fit)                 ? "picture.time.x"
                             : !lanes_of(fit).names.empty() ? "picture.position.x_lanes"
                             : in_space(fit)                ? "picture.position.x_lines"
                                                            : "picture.position.x")
                          : key + "x",
                    {{"axis", fit.axis}, {"unit", unit != nullptr ? unit : unit_text(q)}});
    w.y = words.get(own_y ? key + "y" : "picture.residual", {{"unit", unit_text(up)}});
    w.degrees = fit.rotary && (along || turn) && (along || picture == ResidualPlot::phase);
    if (picture == ResidualPlot::phase) w.x_per_si = unit_of(across).per_si;
    if (along) w.x_per_si = place_scale(fit).per_si;
    if (picture == ResidualPlot::predicted) w.x_per_si = unit_of(up).per_si;
  }
  const auto none = [&](ResidualPlot picture, bool there, const char* key) {
    if (!there) out[static_cast<std::size_t>(picture)].none = words.get(key);
  };
  out[static_cast<std::size_t>(ResidualPlot::time)].x_per_si = 1.0 / seconds;
  out[static_cast<std::size_t>(ResidualPlot::time)].time_unit = time;
  out[static_cast<std::size_t>(ResidualPlot::phase)].none = no_phase(fit, words);
  none(ResidualPlot::position, !over_time(fit), "picture.position.none");
  none(ResidualPlot::reversal, both_directions(fit), "picture.reversal.none");
  none(ResidualPlot::time, any_finite(fit.time), "picture.time.none");
  none(ResidualPlot::run, !fit.run.empty(), "picture.run.none");
  none(ResidualPlot::temperature, any_finite(fit.temperature), "picture.temperature.none");
  none(ResidualPlot::left_out, any_finite(fit.cv_residual), "picture.left-out.none");
  if (fit.size() == 0)
    for (PictureWords& w : out) w.none = words.get("picture.no_readings");
  return out;
}

PictureWords fit_words(const ModelFit& fit, const Wording& words) {
  PictureWords out = picture_words(fit, words).front();
  if (over_time(fit)) out.none.clear();
  out.title = words.get("picture.fit.title");
  out.says = words.get(over_time(fit) ? "picture.fit.says_over_time" : "picture.fit.says");
  out.y = words.get("picture.fit.y", {{"unit", unit_text(deviation_of(fit.angular))}});
  return out;
}

std::vector<Pass> passes_of(const ModelFit& fit) {
  std::map<std::array<std::int64_t, 3>, Pass> passes;
  for (std::size_t i = 0; i < fit.size(); ++i) {
    const std::uint32_t m = i < fit.measurement.size() ? fit.measurement[i] : 0;
    const std::int64_t run = i < fit.run.size() ? fit.run[i] : 0;
    Pass& pass = passes[{m, run, -direction_of(fit, i)}];
    pass.measurement = m;
    pass.direction = direction_of(fit, i);
    pass.rows.push_back(i);
  }
  std::vector<Pass> out;
  for (auto& [key, pass] : passes) {
    auto& rows = pass.rows;
    std::stable_sort(rows.begin(), rows.end(),
                     [&](std::size_t a, std::size_t b) { return fit.target[a] < fit.target[b]; });
    pass.is_path = std::adjacent_find(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
                     return fit.target[a] == fit.target[b];
                   }) == rows.end();
    out.push_back(std::move(pass));
  }
  return out;
}

Normal normal_plot(const ModelFit& fit) {
  constexpr std::size_t outer = 300, inner = 1000;
  const std::size_t n = fit.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fit.residual[a] < fit.residual[b]; });
  const std::size_t step = n > 2 * outer + inner ? (n - 2 * outer) / inner : 1;
  Normal out;
  for (std::size_t i = 0; i < n; ++i) {
    if (i >= outer && i + outer < n && i % step != 0) continue;
    out.values.x.push_back(
        normal_quantile((static_cast<double>(i) + 0.5) / static_cast<double>(n)));
    out.values.y.push_back(fit.residual[order[i]]);
    out.row.push_back(order[i]);
  }
  return out;
}

}  // namespace nonio::reports
