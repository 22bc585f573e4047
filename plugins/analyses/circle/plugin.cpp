// SPDX-License-Identifier: Apache-2.0
// Circular tests (ISO 230-4): deviations of the path and their causes.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "causes.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/results.h"

namespace nonio::circle {
namespace {

std::optional<Followed> named(const std::string& value, const std::string& plane) {
  if (value == "scale_mismatch" || value == "servo_mismatch")
    return Followed{value + ':' + plane, plane};
  if (value == "D") return Followed{"radius:" + plane, plane};
  if (value.size() == 3 && value[1] == '0')
    return Followed{"squareness:" + plane + ".circle", plane};
  if (value.starts_with("bow_")) return Followed{"bow:" + value.substr(4), value.substr(6)};
  for (const auto& [begin, name] :
       {std::pair("B_", "B_circle"), std::pair("lateral_", "lateral"),
        std::pair("cyclicCos_", "cyclic_circle_cos"), std::pair("cyclicSin_", "cyclic_circle_sin")})
    if (value.starts_with(begin)) return Followed{name, value.substr(std::string(begin).size())};
  return std::nullopt;
}

std::string plane_of(const Measurement& m) {
  std::string plane;
  for (const char letter : {'X', 'Y', 'Z'})
    for (const auto& [axis, at] : m.from)
      if (axis.front() == letter) plane += letter;
  return plane;
}

Followed conditions_of(const Measurement& m) {
  Followed out;
  std::map<std::string, double> at = m.at;
  for (const auto& [axis, centre] : m.from) {
    at[axis] = centre;
    if (const auto end = m.to.find(axis); end != m.to.end() && end->second != centre)
      out.numbers.emplace_back("radius", printed(end->second - centre, Quantity::length));
  }
  if (m.feed) out.numbers.emplace_back("feed", *m.feed * 60e3);  // mm/min, as in the manifest
  if (!m.compensation.empty()) out.texts.emplace_back("compensation", m.compensation);
  out.texts.emplace_back("at", positions_text(at));
  return out;
}

/// Selects the values for the history. These quantities differ from those of runs and diagonals
/// because the method differs. Values that are not linear in the readings (G, H, F, amplitudes,
/// spikes) are excluded. Circles are comparable at the same position, radius and feed.
void follow(const Campaign& campaign, const Measurement& m, Evaluation& e) {
  const std::string plane = plane_of(m);
  const Followed conditions = conditions_of(m);
  for (Value& v : e.values) {
    v.followed = named(v.name, plane);
    if (!v.followed) continue;
    v.followed->numbers = conditions.numbers, v.followed->texts = conditions.texts;
    if (const Axis* axis = campaign.machine.axis(v.followed->axis);
        v.followed->quantity.starts_with("cyclic") && axis != nullptr && axis->screw_pitch)
      v.followed->numbers.emplace_back("period", printed(*axis->screw_pitch, Quantity::length));
  }
}

using math::Cause;
using math::CircleReading;
using math::PathCircle;

constexpr std::size_t fewest = 12;
constexpr double per_deg = std::numbers::pi / 180.0, most_left_out = 20.0;  // deg
// Source: docs/dev/constants.md, A12.
constexpr double share_for_attention = 0.2;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "circle"; }

struct Worst {
  double value = -INFINITY;
  std::uint32_t run = 0;
  std::vector<CircleReading> path;
  PathCircle circle;
};

struct Work {
  const AnalysisInput& in;
  Circle circle;
  bool minimum_zone, calibrated;
  math::CircleModel model;
  math::CauseFit fit;
  std::optional<math::CircleNoise> noise;
  math::ReadingModel readings;
  std::optional<math::BudgetOf> budget;
  Evaluation out;

  PathCircle path(const std::vector<CircleReading>& p) const {
    return minimum_zone ? math::minimum_zone(p, circle.R) : math::least_squares_circle(p, circle.R);
  }
  std::set<std::uint32_t> runs() const {
    std::set<std::uint32_t> out_runs;
    for (const CircleReading& r : circle.readings) out_runs.insert(r.run);
    return out_runs;
  }
};

/// Divides the fixed error of the instrument, which is common to all readings, into an offset,
/// which changes the radius, and a gain error (U_fixed at the largest deviation).
void device_errors(Work& w) {
  double largest = 0.0, mean = 0.0;
  for (const auto& bin : w.fit.bins) mean += bin.deviation / static_cast<double>(w.fit.bins.size());
  for (const auto& bin : w.fit.bins) largest = std::max(largest, std::fabs(bin.deviation - mean));
  for (auto& input : w.readings.inputs) {
    if (input.is.id != "device-fixed") continue;
    const double u = input.is.u;
    std::vector<double> offset(w.fit.bins.size(), u), gain;
    for (const auto& bin : w.fit.bins)
      gain.push_back(largest > 0.0 ? u * (bin.deviation - mean) / largest : 0.0);
    input.is.correlation = Correlation::device;
    input.patterns = {std::move(offset), std::move(gain)};
  }
}

void begin_budget(Work& w) {
  std::vector<math::BudgetLine> lines;
  for (const int direction : {1, -1}) {
    math::BudgetLine line;
    // An error common to all radii affects the result only if the length is calibrated.
    line.kind = w.calibrated ? math::BudgetLine::Kind::length : math::BudgetLine::Kind::lateral;
    for (const auto& bin : w.fit.bins)
      if (bin.direction == direction) line.length.push_back(w.circle.R);
    const std::array<double, 2> half{std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0};
    math::put_expansion(line, w.in.campaign, w.circle.axis, half);
    if (!line.length.empty()) lines.push_back(std::move(line));
  }
  Environment environment = w.in.campaign.environment;
  const Observations* const all[] = {&w.in.observations};
  math::HeldLimits held = math::limits_held(w.in.campaign, all);
  w.readings = math::reading_model(w.in.campaign, held.environment, std::move(lines));
  device_errors(w);
  for (Finding& f : held.findings) w.out.findings.push_back(std::move(f));
  if (!w.readings.missing.empty())
    w.out.findings.push_back(math::missing_finding(w.readings.missing));
  w.budget.emplace(w.readings, w.fit.s, w.fit.dof, Quantity::deviation);
}

/// Derivative of the radial distance of reading `outer` (minus that of `inner`, if given) from the
/// least-squares center, with respect to the means of the fit.
std::vector<double> by_bins(const Work& w, const std::vector<CircleReading>& path,
                            std::size_t outer, std::optional<std::size_t> inner) {
  std::vector<double> row(w.fit.bins.size(), 0.0);
  bool plus = false, minus = false;
  for (const CircleReading& r : path) (r.direction > 0 ? plus : minus) = true;
  double n = 0.0;
  for (const auto& bin : w.fit.bins) n += (bin.direction > 0 ? plus : minus) ? 1.0 : 0.0;
  const auto add = [&](std::size_t i, double sign) {
    const CircleReading& r = path[i];
    std::size_t nearest = 0;
    double distance = INFINITY;
    for (std::size_t b = 0; b < w.fit.bins.size(); ++b) {
      const auto& bin = w.fit.bins[b];
      const double off = std::fabs(std::remainder(bin.angle - r.angle, 2.0 * std::numbers::pi));
      if (bin.direction == r.direction && off < distance) nearest = b, distance = off;
      if (bin.direction > 0 ? plus : minus)
        row[b] -= sign * 2.0 / n * std::cos(bin.angle - r.angle);
    }
    row[nearest] += sign;
  };
  add(outer, 1.0);
  if (inner) add(*inner, -1.0);
  return row;
}

void add(Work& w, std::string name, double v, Quantity q, double u, const std::vector<double>& by) {
  v = steady(v, std::max(std::fabs(v), u)), u = steady(u, u);
  math::Shares shares = w.readings.shares(by);
  // Shares that cancel leave rounding errors, which are set to 0.
  double largest = 0.0;
  for (const double share : shares.u) largest = std::max(largest, std::fabs(share));
  for (double& share : shares.u)
    share = std::fabs(share) < 1e-9 * largest ? 0.0 : steady(share, std::fabs(share));
  w.out.values.push_back(w.budget->value(std::move(name), v, q, u, shares));
}

template <class Of>
double noise_adds(const Work& w, int direction, std::uint32_t run, const Of& value) {
  return w.noise->adds([&](const std::vector<CircleReading>& all) {
    std::vector<CircleReading> path;
    for (const CircleReading& r : all)
      if (r.run == run && (direction == 0 || r.direction == direction)) path.push_back(r);
    return value(path);
  });
}

/// Standard uncertainty by repetition of a maximum: noise of `readings` single readings, and the
/// bias `adds` of a maximum due to noise. The value is not corrected for this bias.
double repetition(const Work& w, double readings, double adds) {
  return std::hypot(std::sqrt(readings) * w.fit.s_reading, adds);
}

void path_values(Work& w) {
  for (const auto& [name, direction] : {std::pair{"G_ccw", 1}, {"G_cw", -1}, {"G_b", 0}}) {
    if (direction == 0 && !w.circle.both()) continue;
    Worst worst;
    for (const std::uint32_t run : w.runs()) {
      std::vector<CircleReading> path = w.circle.of(direction, run);
      if (path.size() < fewest) continue;
      const PathCircle c = w.path(path);
      if (c.width() > worst.value) worst = {c.width(), run, std::move(path), c};
    }
    if (worst.path.empty()) continue;
    // The noise has the same effect about the least-squares center, which is faster to compute.
    const double adds = noise_adds(w, direction, worst.run, [&](const auto& path) {
      return math::least_squares_circle(path, w.circle.R).width();
    });
    add(w, name, worst.value, Quantity::deviation, repetition(w, 2.0, adds),
        by_bins(w, worst.path, worst.circle.outermost, worst.circle.innermost));
  }
  std::optional<math::Hysteresis> H;
  std::uint32_t run_of_H = 0;
  std::array<double, 2> centre{};
  for (const std::uint32_t run : w.runs()) {
    const auto path = w.circle.of(0, run);
    if (path.size() < 2 * fewest) continue;
    const auto about = w.path(path).centre;
    const auto h = math::circular_hysteresis(path, w.circle.R, about, w.circle.step);
    if (h && (!H || h->H > H->H)) H = h, run_of_H = run, centre = about;
  }
  if (!H) return;
  const std::vector<CircleReading> pair{{H->angle, 0.0, 1, 1}, {H->angle, 0.0, -1, 1}};
  const double adds = noise_adds(w, 0, run_of_H, [&](const auto& path) {
    const auto h = math::circular_hysteresis(path, w.circle.R, centre, w.circle.step);
    return h ? h->H : 0.0;
  });
  add(w, "H", H->H, Quantity::deviation, repetition(w, 2.0, adds), by_bins(w, pair, 0, 1));
}

void circle_values(Work& w) {
  const auto ls = math::least_squares_circle(w.circle.readings, w.circle.R),
             mz = math::minimum_zone(w.circle.readings, w.circle.R);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& v = w.fit.of[static_cast<std::size_t>(k == 0 ? Cause::centre_u : Cause::centre_v)];
    add(w, "centre_" + w.circle.axis[k], ls.centre[k], Quantity::deviation, v.u, v.by_bin);
  }
  for (std::size_t k = 0; k < 2; ++k)
    w.out.values.push_back({"centreMZ_" + w.circle.axis[k], mz.centre[k], Quantity::deviation});
  if (!w.calibrated) {
    w.out.findings.push_back({.id = "circle.length-not-calibrated", .attention = false});
    return;
  }
  const auto& radius = w.fit.of[static_cast<std::size_t>(Cause::radius)];
  if (w.circle.both()) add(w, "D", ls.radius, Quantity::deviation, radius.u, radius.by_bin);
  const bool commanded = w.in.options.text("F_about") == "commanded";
  const auto centre = commanded ? std::array<double, 2>{} : ls.centre;
  const PathCircle F = math::about(w.circle.readings, w.circle.R, centre);
  for (const bool outer : {true, false}) {
    std::vector<double> by =
        by_bins(w, w.circle.readings, outer ? F.outermost : F.innermost, std::nullopt);
    const double adds = w.noise->adds([&](const std::vector<CircleReading>& all) {
      const PathCircle again = math::about(all, w.circle.R, centre);
      return outer ? again.outer : again.inner;
    });
    add(w, outer ? "F_max" : "F_min", outer ? F.outer : F.inner, Quantity::deviation,
        repetition(w, 1.0, adds), by);
  }
}

math::Spike worst_spike(const Work& w, const std::vector<CircleReading>& readings, bool of_v) {
  math::Spike worst;
  for (const math::Spike& s : math::reversal_spikes(readings, w.model, w.fit))
    if (s.of_v == of_v && std::fabs(s.height) > std::fabs(worst.height)) worst = s;
  return worst;
}

void spikes(Work& w, double total) {
  for (std::size_t k = 0; k < 2; ++k) {
    const math::Spike worst = worst_spike(w, w.circle.readings, k == 1);
    if (worst.height == 0.0) continue;
    const double adds = w.noise->adds([&](const std::vector<CircleReading>& all) {
      return std::fabs(worst_spike(w, all, k == 1).height);
    });
    add(w, "spike_" + w.circle.axis[k], worst.height, Quantity::deviation,
        std::hypot(worst.u, adds), std::vector<double>(w.fit.bins.size(), 0.0));
    // Source: docs/dev/constants.md, A13.
    if (!(std::fabs(worst.height) > 4.0 * worst.u)) continue;  // also false if all readings are 0
    const double alone = std::fabs(worst.height), share = alone / (total + alone);
    w.out.findings.push_back({.id = "circle.spikes",
                              .attention = share >= share_for_attention,
                              .evidence = {{"value", worst.height, Quantity::deviation},
                                           {"alone", alone, Quantity::deviation},
                                           {"share", share, Quantity::ratio},
                                           {"at", worst.at, Quantity::angle},
                                           {"width", worst.width, Quantity::angle}},
                              .texts = {{"axis", w.circle.axis[k]}}});
  }
}

void causes(Work& w, const Wish& wish) {
  std::vector<Finding> refused;
  const auto values = cause_values(w.circle, w.model, w.fit, wish, refused);
  double total = 0.0;
  for (const CauseValue& v : values) total += v.alone;
  std::vector<std::pair<double, Finding>> ranked;
  for (const CauseValue& v : values) {
    add(w, v.name, v.value, v.quantity, v.u, v.by_bin);
    const Value& last = w.out.values.back();
    const double U = last.U.value_or(last.repeatability.value_or(2.0 * v.u));
    if (v.finding.empty() || !(std::fabs(v.value) > U) || !(total > 0.0)) continue;
    const double share = v.alone / total;
    Finding f{
        .id = v.finding,
        .attention = share >= share_for_attention,
        .evidence = {{"value", v.value, v.quantity},
                     {"U", U, v.quantity},
                     {"alone", v.alone, Quantity::deviation},
                     {"share", share, Quantity::ratio}},
        .texts = {{"name", v.name}, {"first", w.circle.axis[0]}, {"second", w.circle.axis[1]}}};
    if (!v.axis.empty()) f.texts.emplace_back("axis", v.axis);
    if (v.quantity == Quantity::time) {  // the message needs 0.42 ms, not 0.00042 s
      f.evidence.push_back({"value_ms", 1e3 * v.value, Quantity::number});
      f.evidence.push_back({"U_ms", 1e3 * U, Quantity::number});
    }
    ranked.emplace_back(share, std::move(f));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [share, f] : ranked) w.out.findings.push_back(std::move(f));
  spikes(w, total);
  const auto& change = w.fit.of[static_cast<std::size_t>(Cause::zero_change)];
  if (change.fitted && std::fabs(change.value) > 3.0 * change.u)
    w.out.findings.push_back({.id = "circle.zero-changed",
                              .attention = false,
                              .evidence = {{"change", 2.0 * change.value, Quantity::deviation},
                                           {"u", 2.0 * change.u, Quantity::deviation}}});
  for (Finding& f : refused) w.out.findings.push_back(std::move(f));
}

void points(Work& w) {
  constexpr std::size_t sectors = 36;
  std::array<std::array<double, sectors>, 2> sum{}, n{};
  for (const CircleReading& r : w.circle.readings) {
    const auto at = static_cast<std::size_t>(r.angle / per_deg / 10.0) % sectors;
    sum[r.direction > 0 ? 0 : 1][at] += r.deviation;
    n[r.direction > 0 ? 0 : 1][at] += 1.0;
  }
  PointTable::Column target{"target", Quantity::angle, {}}, ccw{"ccw", Quantity::deviation, {}},
      cw{"cw", Quantity::deviation, {}};
  for (std::size_t i = 0; i < sectors; ++i) {
    target.values.push_back((10.0 * static_cast<double>(i) + 5.0) * per_deg);
    ccw.values.push_back(n[0][i] > 0.0 ? sum[0][i] / n[0][i] : NAN);
    cw.values.push_back(n[1][i] > 0.0 ? sum[1][i] / n[1][i] : NAN);
  }
  w.out.points.columns = {std::move(target), std::move(ccw), std::move(cw)};
}

math::CircleModel model_of(const Work& w) {
  math::CircleModel m;
  m.R = w.circle.R;
  m.centre = w.circle.centre;
  for (std::size_t k = 0; k < 2; ++k)
    if (const Axis* axis = w.in.campaign.machine.axis(w.circle.axis[k]); axis != nullptr)
      m.pitch[k] = axis->screw_pitch.value_or(0.0);
  m.leave_out = w.in.options.number("leave_out_deg", 2.0) * per_deg;
  math::all_causes(m, w.circle.both());
  return m;
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  NONIO_TRY(auto circle, circle_of(in.measurement, in.observations));
  Work w{in,
         std::move(circle),
         in.options.text("centre") != "least-squares",
         in.options.flag("calibrated_length"),
         {},
         {},
         {},
         {},
         {},
         {}};
  w.model = model_of(w);
  const double stated = w.model.leave_out;
  auto fit = math::fit_causes_without_spikes(w.circle.readings, w.model, most_left_out * per_deg);
  if (!fit) {
    w.out.findings.push_back(
        {.id = "circle.refused-few",
         .attention = true,
         .evidence = {{"readings", static_cast<double>(in.observations.size()), Quantity::count}}});
    return std::move(w.out);
  }
  w.fit = std::move(*fit);
  for (double* x : {&w.fit.s, &w.fit.s_reading, &w.fit.dof}) *x = steady(*x, *x);
  w.noise.emplace(w.circle.readings, w.model, w.fit);
  if (w.model.leave_out > stated)
    w.out.findings.push_back({.id = "circle.spikes-last",
                              .attention = false,
                              .evidence = {{"stated", stated, Quantity::angle},
                                           {"left_out", w.model.leave_out, Quantity::angle}}});
  w.out.notes.push_back({w.minimum_zone ? "method.circle-mz" : "method.circle-ls"});
  begin_budget(w);
  path_values(w);
  circle_values(w);
  causes(w, {.calibrated_length = w.calibrated, .feed = in.measurement.feed});
  w.out.values.push_back({"s", w.fit.s, Quantity::deviation});
  follow(in.campaign, in.measurement, w.out);
  points(w);
  if (w.readings.missing.empty()) w.out.budget = w.budget->budget();
  return std::move(w.out);
}

std::vector<Option> options() {
  return {
      one_of({"minimum-zone", "least-squares"}, {"centre", std::string("minimum-zone"), "",
                                                 "Centre of the two circles of G, G(b) and H."}),
      {"F_about",
       std::string("least-squares"),
       "",
       "Centre of F: the least-squares one, or the commanded one if the bar's ball was there.",
       {"least-squares", "commanded"}},
      {"calibrated_length", false, "",
       "Whether the readings are deviations from the commanded radius (a calibrated bar): "
       "needed for D and F."},
      within(0.0, most_left_out,
             {"leave_out_deg", 2.0, "deg",
              "Readings left out of the fit on both sides of each reversal; more where spikes last "
              "longer."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"circle", "1.0.0",
            "Circular tests (ISO 230-4): deviations of the path, and their causes.", options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::circle
