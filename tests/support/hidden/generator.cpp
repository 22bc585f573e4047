// SPDX-License-Identifier: Apache-2.0
#include "hidden/generator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "catalogue.h"

namespace nonio::hidden {
namespace {

Campaign campaign_of(const Scenario& s, const Truth& truth) {
  Campaign campaign;
  campaign.id = "hidden-" + std::to_string(s.seed);
  campaign.customer = "Simulated";
  Axis axis;
  axis.name = s.rotary ? "C" : "X";
  axis.rotary = s.rotary;
  if (s.pitch_known && s.rotary) axis.teeth = s.teeth;
  if (s.pitch_known && !s.rotary) axis.screw_pitch = s.pitch;
  campaign.machine.axes.push_back(axis);
  Measurement m;
  m.id = axis.name;
  m.kind = "axis";
  m.axis = axis.name;
  m.file = "readings.csv";
  campaign.measurements.push_back(m);
  campaign.model = truth.model;
  return campaign;
}

Observations table_of(const Scenario& s, const Cycle& c) {
  Observations o;
  o.measurement = s.rotary ? "C" : "X";
  o.angular = s.rotary;
  Observations::AxisColumn column;
  column.axis = o.measurement;
  column.rotary = s.rotary;
  column.position = c.position;
  for (const double d : c.d) column.approach.push_back(d > 0.0 ? std::int8_t{1} : std::int8_t{-1});
  o.axes.push_back(std::move(column));
  o.lines.push_back({o.measurement, {s.rotary ? 0.0 : 1.0, 0.0, 0.0}});
  o.run = c.run;
  for (std::size_t i = 0; i < c.size(); ++i)
    o.source_line.push_back(static_cast<std::uint32_t>(i + 2));
  if (s.timed) o.time = c.t;
  if (s.temperatures) o.material = c.material;
  return o;
}

/// Where something outside the catalogue shows; the best first.
std::vector<std::string> places_of(Source source, bool rotary) {
  const std::string position = rotary ? "angle" : "position";
  switch (source) {
    case Source::dent:
      return {position, "position"};
    case Source::sawtooth:
      return {position, "position", "screw-phase"};
    case Source::creeping_reversal:
      return {"direction x time", "direction x run", "direction"};
    case Source::zero_walk:
      return {"time", "run"};
    case Source::travel_hysteresis:
      return {"direction x " + position, "direction x position", "direction"};
    case Source::wild_run:
      return {"run"};
    default:
      return {};
  }
}

std::string verdict_of(const Scenario& s) {
  if (s.hidden.empty()) return "nothing";
  const Source first = s.hidden.front().source;
  if (first == Source::wild_run || first == Source::contradiction) return "unrepeatable";
  return kind_of(first).empty() ? "unknown" : "missing";
}

/// Adds what is true of one cause to the truth.
void state(Truth& truth, const Piece& piece, const Cause& cause, const Cycle& c,
           const Scenario& s) {
  const std::string kind = kind_of(piece.source);
  if (kind.empty()) {
    truth.places = places_of(piece.source, s.rotary);
    truth.at = cause.at;
    return;
  }
  Columns columns = best_columns(kind, cause.deviation, c, s);
  columns.insert(columns.begin(), std::vector<double>(c.size(), 1.0));
  const Projection fitted = project(cause.deviation, columns);
  const std::vector<std::string> names = parameters_of(kind);
  const std::string effect = kind + (s.rotary ? ":C" : ":X");
  for (std::size_t k = 0; k < names.size(); ++k)
    truth.values.push_back({effect, names[k], fitted.coefficient[k + 1]});
  truth.imperfection.push_back(kind == "pitch-curve" ? std::numeric_limits<double>::quiet_NaN()
                                                     : rms_about_mean(fitted.left) / s.noise);
}

/// What is added to the readings' independent noise: a random walk, and a zero of each run.
std::vector<double> wandering(const Scenario& s, const Cycle& c) {
  std::vector<double> out(c.size(), 0.0);
  if (s.unrest.walk > 0.0) {
    Random steps(s.seed, 9);
    double at = 0.0;
    for (double& x : out) x = at += steps.normal();
    const double size = s.unrest.walk / rms_about_mean(out);
    for (double& x : out) x *= size;
  }
  Random zeros(s.seed, 7);
  double zero = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (i == 0 || c.run[i] != c.run[i - 1]) zero = s.unrest.run_zero * zeros.normal();
    out[i] += zero;
  }
  return out;
}

/// How much more each reading scatters than the noise.
std::vector<double> roughness(const Scenario& s, const Cycle& c) {
  Random where(s.seed, 8);
  const double long_ = where.uniform(0.25, 0.5) * c.length;
  const double from = c.targets.front() + where.uniform(0.0, 1.0) * (c.length - long_);
  std::vector<double> out(c.size(), 1.0);
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.position[i] >= from && c.position[i] <= from + long_) out[i] = s.unrest.rough;
  return out;
}

void measure(Hidden& h, const Cycle& c) {
  const Scenario& s = h.scenario;
  Random noise(s.seed, 4), wrong(s.seed, 5);
  const double zero = noise.uniform(-10.0, 10.0) * s.noise;
  const double fine = s.rotary ? pi / 180.0 / 3600.0 * 1e-4 : 1e-10;
  const double resolution = s.unrest.digit > 0.0
                                ? std::max(1.0, std::round(s.unrest.digit * s.noise / fine)) * fine
                                : fine;
  const std::vector<double> wander = wandering(s, c), rough = roughness(s, c);
  const double rho = s.unrest.correlation;
  double before = 0.0;
  const std::size_t only = s.one_misread ? Random(s.seed, 6).below(c.size()) : c.size();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double fresh = noise.normal();
    before = i == 0 ? fresh : rho * before + std::sqrt(1.0 - rho * rho) * fresh;
    double e = zero + s.noise * (rough[i] * before + wander[i]);
    for (const auto& cause : h.causes) e += cause[i];
    const bool misread = s.one_misread ? i == only : wrong.flag(s.misread);
    const double by = wrong.sign() * wrong.uniform(8.0, 40.0) * s.noise;
    if (misread) e += by, h.misread.push_back(i);
    h.table.deviation.push_back(std::round(e / resolution) * resolution);
  }
}

/// A thermometer that is read at every second to fifth reading only, that now and then gives
/// nothing, or that was off for a while.
void blank(Hidden& h) {
  Random random(h.scenario.seed, 7);
  std::vector<double>& material = h.table.material;
  const std::size_t n = material.size(), way = random.below(3);
  const std::size_t every = random.whole(2, 5), length = n / random.whole(6, 12);
  const std::size_t off = random.whole(1, n - length - 1);
  const double share = random.uniform(0.05, 0.4);
  for (std::size_t i = 0; i < n; ++i)
    if (way == 0 ? i % every != 0 : way == 1 ? random.flag(share) : i >= off && i < off + length)
      material[i] = std::numeric_limits<double>::quiet_NaN();
}

/// All readings towards + before all towards -, each group run by run and its targets ascending.
void group(Hidden& h) {
  Observations& o = h.table;
  std::vector<std::size_t> rows(o.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto& axis = o.axes.front();
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(-axis.approach[a], o.run[a], axis.position[a]) <
           std::tuple(-axis.approach[b], o.run[b], axis.position[b]);
  });
  const auto arrange = [&](auto& column) {
    const auto listed = column;
    for (std::size_t i = 0; i < rows.size() && !listed.empty(); ++i) column[i] = listed[rows[i]];
  };
  arrange(o.axes.front().position);
  arrange(o.axes.front().approach);
  arrange(o.deviation);
  arrange(o.material);
  arrange(o.run);
  for (auto& cause : h.causes) arrange(cause);
  for (std::size_t& row : h.misread)
    row = static_cast<std::size_t>(std::find(rows.begin(), rows.end(), row) - rows.begin());
}

}  // namespace

Hidden generate(const Scenario& s) {
  const Cycle c = cycle_of(s);
  Hidden h;
  h.scenario = s;
  h.truth.verdict = verdict_of(s);
  const std::string axis = s.rotary ? ":C" : ":X";
  std::uint64_t stream = 10;
  const auto add = [&](const Piece& piece, std::vector<std::string>& names) {
    Cause cause =
        simulate_sized(piece.source, c, s, Random(s.seed, stream++), piece.size * s.noise);
    if (const std::string kind = kind_of(piece.source); !kind.empty()) names.push_back(kind + axis);
    state(h.truth, piece, cause, c, s);
    h.causes.push_back(std::move(cause.deviation));
  };
  for (const Piece& piece : s.model) add(piece, h.truth.model);
  for (const Piece& piece : s.hidden) add(piece, h.truth.hidden);
  h.campaign = campaign_of(s, h.truth);
  h.table = table_of(s, c);
  measure(h, c);
  if (s.kind == Kind::grouped) group(h);
  if (s.kind == Kind::blank_temperatures) blank(h);
  return h;
}

}  // namespace nonio::hidden
