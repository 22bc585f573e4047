// SPDX-License-Identifier: Apache-2.0
// Thermal tests (ISO 230-3): a machine at rest (ETVE), a rotating spindle, or a cycling axis.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "nonio/math/differences.h"
#include "nonio/math/thermal.h"

namespace nonio::thermal {

namespace {

/// `loaded`: a speed or load was recorded as a channel, so the machine was not at rest.
enum class Test { etve, loaded, spindle, axis };

/// One sensor, or a tilt from two sensors; 0 at its first reading.
struct Followed {
  std::string name;    ///< X, Y1; for a tilt A (about X) or B (about Y)
  math::Track run;     ///< from start to stop of a spindle, otherwise the whole test
  math::Track cool;    ///< from the stop on, 0 at the stop; empty without a stop
  bool tilt = false;   ///< whether values are in rad instead of m
  double lever = 0.0;  ///< distance of the sensors of a tilt, m
};

struct Tracks {
  Test test = Test::etve;
  std::vector<Followed> all;
  std::vector<math::Visits> visits;  ///< readings of an axis test by position
  bool speed_steps = false;
  Quantity deviation = Quantity::deviation;  ///< of the sensors; angular_deviation: tilts in rad
  std::vector<Finding> findings;
};

/// Start and stop of the spindle. The speed of a row applies until the next row.
struct Run {
  std::size_t start = 0, stop = 0;
  bool stopped = false;
};

std::optional<Run> run_of(const Observations& o, const std::vector<std::size_t>& rows,
                          Tracks& out) {
  const auto& s = o.axes.front();
  const auto turns = [&](std::size_t k) { return s.approach[rows[k]] != 0; };
  Run run;
  while (run.start < rows.size() && !turns(run.start)) ++run.start;
  if (run.start == rows.size()) return {};
  run.stop = run.start;
  while (run.stop + 1 < rows.size() && turns(run.stop)) ++run.stop;
  run.stopped = !turns(run.stop);
  for (std::size_t k = run.stop; k < rows.size() && run.stopped; ++k)
    if (turns(k)) {
      out.findings.push_back({.id = "thermal.several-runs", .attention = true});
      break;
    }
  double slowest = INFINITY, fastest = 0.0;
  for (std::size_t k = run.start; k < run.stop; ++k) {
    const double speed = std::fabs((s.position[rows[k + 1]] - s.position[rows[k]]) /
                                   (o.time[rows[k + 1]] - o.time[rows[k]]));
    slowest = std::min(slowest, speed), fastest = std::max(fastest, speed);
  }
  constexpr double same = 0.02;
  out.speed_steps = out.speed_steps || slowest < (1.0 - same) * fastest;
  return run;
}

math::Track cut(const math::Track& k, std::size_t first, std::size_t last) {
  math::Track out;
  for (std::size_t i = first; i <= last && i < k.size(); ++i) {
    out.time.push_back(k.time[i] - k.time[first]);
    out.d.push_back(k.d[i] - k.d[first]);
  }
  return out;
}

Followed followed(std::string name, const math::Track& whole, const std::optional<Run>& run) {
  Followed f;
  f.name = std::move(name);
  if (!run) {
    f.run = cut(whole, 0, whole.size() - 1);
    return f;
  }
  f.run = cut(whole, run->start, run->stop);
  if (run->stopped) f.cool = cut(whole, run->stop, whole.size() - 1);
  return f;
}

math::Track tilt_of(const math::Track& one, const math::Track& two, double distance) {
  math::Track out;
  std::size_t j = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    while (j < two.size() && two.time[j] < one.time[i]) ++j;
    if (j == two.size() || two.time[j] != one.time[i]) continue;
    out.time.push_back(one.time[i]);
    out.d.push_back((one.d[i] - two.d[j]) / distance);
  }
  return out;
}

void add_tilts(const Measurement& m, const std::map<std::string, math::Track>& tracks,
               const std::map<std::string, std::optional<Run>>& runs, Tracks& out) {
  for (const auto& [name, letter] : {std::pair{"B", "X"}, {"A", "Y"}}) {
    const auto one = tracks.find(std::string(letter) + "1"),
               two = tracks.find(std::string(letter) + "2");
    if (one == tracks.end() || two == tracks.end()) continue;
    if (!m.foot) {
      out.findings.push_back(
          {.id = "thermal.no-tilt", .attention = false, .texts = {{"axis", letter}}});
      continue;
    }
    math::Track tilt = tilt_of(one->second, two->second, *m.foot);
    if (tilt.size() < 2 || tilt.size() != one->second.size()) continue;
    Followed f = followed(name, tilt, runs.at(one->first));
    f.tilt = true, f.lever = *m.foot;
    out.all.push_back(std::move(f));
  }
}

bool is_loaded(const Observations& o) {
  return std::any_of(o.channels.begin(), o.channels.end(), [](const Observations::Channel& c) {
    return c.unit != "degC" &&
           std::any_of(c.value.begin(), c.value.end(), [](double v) { return v != 0.0; });
  });
}

/// Displacement of each sensor, divided at start and stop of a spindle; for an axis test, its
/// visits of the targets.
Tracks tracks_of(const Measurement& m, const Observations& o) {
  Tracks out;
  out.deviation = deviation_of(o.angular);
  if (!m.axis.empty()) {
    out.test = Test::axis;
    out.visits = math::visits_of(o);
    if (auto dead = math::dead_sensor(m.axis, o.deviation)) out.findings.push_back(*dead);
    return out;
  }
  const bool spindle = !o.axes.empty() && o.axes.front().approach.size() == o.size() &&
                       std::any_of(o.axes.front().approach.begin(), o.axes.front().approach.end(),
                                   [](std::int8_t a) { return a != 0; });
  out.test = spindle ? Test::spindle : is_loaded(o) ? Test::loaded : Test::etve;
  std::vector<std::vector<std::size_t>> rows(o.lines.size());
  for (std::size_t i = 0; i < o.size(); ++i) rows[o.line_of(i)].push_back(i);
  std::map<std::string, math::Track> tracks;
  std::map<std::string, std::optional<Run>> runs;
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    if (rows[line].size() < 2) continue;
    auto [kept, track] = math::in_time(o, std::move(rows[line]));
    if (track.size() < 2) continue;
    if (auto dead = math::dead_sensor(o.lines[line].name, track.d, out.deviation)) {
      out.findings.push_back(*dead);
      continue;
    }
    std::optional<Run> run;
    if (spindle) run = run_of(o, kept, out);
    out.all.push_back(followed(o.lines[line].name, track, run));
    runs[o.lines[line].name] = run;
    tracks[o.lines[line].name] = std::move(track);
  }
  add_tilts(m, tracks, runs, out);
  std::sort(out.findings.begin(), out.findings.end(),
            [](const Finding& a, const Finding& b) { return a.id < b.id; });
  out.findings.erase(std::unique(out.findings.begin(), out.findings.end(),
                                 [](const Finding& a, const Finding& b) {
                                   return a.id == b.id && a.texts == b.texts;
                                 }),
                     out.findings.end());
  return out;
}

struct Wish {
  double window = 3600.0;   ///< s
  double remaining = 1e-6;  ///< m, permitted change after the warm-up
};

using Item = math::Difference;

/// Results of the tracks, and findings for results that cannot be computed.
struct Worked {
  std::vector<Item> items;
  std::vector<Finding> findings;
  std::vector<Series> series;
  PointTable points;
  double drift = 0.0;  ///< largest change in a window of a machine at rest, m; 0 if not known
  std::string drift_sensor;
};

using math::RangeOf;
using math::TimeConstants;
using math::Track;

constexpr double per_min = 1.0 / 60.0;

Number minutes(const char* name, double s) { return {name, s * per_min, Quantity::number}; }

class Worker {
 public:
  Worker(const Tracks& tracks, const Measurement& m, const Wish& wish)
      : tracks_(tracks), m_(m), wish_(wish) {}

  Worked run() {
    out_.findings = tracks_.findings;
    if (tracks_.test == Test::axis && tracks_.findings.empty())
      exercised();
    else
      for (const Followed& f : tracks_.all) one(f);
    settle();
    return std::move(out_);
  }

 private:
  bool is_angular() const { return tracks_.deviation == Quantity::angular_deviation; }
  Quantity quantity_of(const Followed& f) const {
    return f.tilt ? Quantity::small_angle : tracks_.deviation;
  }

  /// The u of a range contains two readings and the bias of maximum and minimum by noise.
  Item range_item(const std::string& name, const Track& k, const RangeOf& r, const Followed& f) {
    const auto noise = math::reading_noise(k);
    const std::span<const double> d(k.d);
    const auto first = static_cast<std::size_t>(
        std::lower_bound(k.time.begin(), k.time.end(), r.from) - k.time.begin());
    const auto last = static_cast<std::size_t>(
        std::upper_bound(k.time.begin(), k.time.end(), r.to) - k.time.begin());
    const double excess = math::range_excess(d.subspan(first, last - first), noise.s);
    const double scale = f.tilt ? 1.0 / f.lever : 1.0, metre = f.tilt ? f.lever : 1.0;
    return {.name = name + "_" + f.name,
            .value = r.range,
            .quantity = quantity_of(f),
            .u = std::sqrt(2.0 * noise.s * noise.s + 2.0 * excess * excess),
            .dof = noise.dof,
            .from = k.d[r.low] * metre,
            .to = k.d[r.high] * metre,
            .scale = scale};
  }

  void put_ranges(const Followed& f) {
    const Track& k = f.run;
    if (const auto whole = math::whole_range(k))
      out_.items.push_back(range_item("range", k, *whole, f));
    const auto window = math::largest_range(k, wish_.window),
               first = math::first_range(k, wish_.window);
    if (!window || !first) {
      once("thermal.window-longer", {minutes("window_min", wish_.window),
                                     minutes("test_min", k.time.back() - k.time.front())});
      return;
    }
    out_.items.push_back(range_item("window", k, *window, f));
    out_.items.push_back(range_item("first", k, *first, f));
    if (tracks_.test == Test::etve && !f.tilt && !is_angular() && window->range > out_.drift)
      out_.drift = window->range, out_.drift_sensor = f.name;
    double widest = 0.0;
    for (std::size_t i = 1; i < k.size(); ++i) widest = std::max(widest, k.time[i] - k.time[i - 1]);
    // docs/dev/constants.md, A16: a window with fewer readings can miss its extremes.
    if (widest > wish_.window / 4.0)
      once("thermal.sparse", {minutes("step_min", widest), minutes("window_min", wish_.window)});
  }

  void put_end(const Followed& f, const char* name, const Track& k) {
    if (k.size() < 2) return;
    const auto noise = math::reading_noise(k);
    const double metre = f.tilt ? f.lever : 1.0;
    out_.items.push_back({.name = std::string(name) + "_" + f.name,
                          .value = k.d.back() - k.d.front(),
                          .quantity = quantity_of(f),
                          .u = std::numbers::sqrt2 * noise.s,
                          .dof = noise.dof,
                          .from = k.d.front() * metre,
                          .to = k.d.back() * metre,
                          .scale = 1.0 / metre});
  }

  /// A sensor that was touched states nothing about the machine at rest, nor does a tilt of it.
  bool touched(const Followed& f) {
    if (f.tilt) {
      const std::string sensor = f.name == "A" ? "Y" : "X";
      return jumping_.contains(sensor + "1") || jumping_.contains(sensor + "2");
    }
    for (const math::Jump& jump : math::jumps_of(f.run)) {
      jumping_.insert(f.name);
      out_.findings.push_back({.id = "thermal.jump",
                               .attention = true,
                               .evidence = {{"jump", jump.size, quantity_of(f)},
                                            minutes("from_min", f.run.time[jump.before]),
                                            minutes("to_min", f.run.time[jump.before + 1])},
                               .texts = {{"sensor", f.name}}});
    }
    return jumping_.contains(f.name);
  }

  void one(const Followed& f) {
    if (f.run.size() < 2) return;
    if (tracks_.test == Test::etve && touched(f)) return;
    put_ranges(f);
    if (tracks_.test != Test::spindle) return;
    put_end(f, "end", f.run);
    put_end(f, "cool", f.cool);
    if (f.tilt) return;
    if (tracks_.speed_steps) return once("thermal.speed-steps", {});
    put_constants(f.name, f.run, 1.0, tracks_.deviation, 1.0);
  }

  /// `lever` of a growth: distance at which its rest is judged, m; `start`: time of the first
  /// reading after the start of the heating, s, at which c is 0.
  TimeConstants put_constants(const std::string& name, const Track& k, double lever,
                              Quantity quantity, double scale, double start = 0.0) {
    const TimeConstants fit = math::time_constants(k);
    using Answer = TimeConstants::Answer;
    if (fit.answer != Answer::resolved) {
      refuse(name, k, fit);
      return fit;
    }
    for (std::size_t i = 0; i < fit.parts.size(); ++i) {
      const auto& p = fit.parts[i];
      const std::string number = i == 0 ? "" : "2";
      const double before = std::exp(start / p.tau);
      out_.items.push_back({.name = "tau" + number + "_" + name,
                            .value = p.tau,
                            .quantity = Quantity::time,
                            .u = p.u_tau,
                            .dof = fit.dof});
      out_.items.push_back({.name = "c" + number + "_" + name,
                            .value = before * p.c,
                            .quantity = quantity,
                            .u = before * p.u_c,
                            .dof = fit.dof,
                            .to = before * p.c / scale,
                            .scale = scale});
    }
    if (!is_angular()) {
      const auto t = fit.settled(wish_.remaining / lever);
      if (start + t.t >= slowest_) slowest_ = start + t.t, slowest_u_ = t.u, slowest_name_ = name;
    }
    put_curve(name, fit, k);
    return fit;
  }

  void put_curve(const std::string& name, const TimeConstants& fit, const Track& k) {
    Series s{"fit_" + name, "t", Quantity::time, tracks_.deviation, {}, {}, {}};
    if (tracks_.test == Test::axis) s.quantity = Quantity::deviation_per_length;
    constexpr int steps = 100;
    for (int i = 0; i <= steps; ++i) {
      s.position.push_back((k.time.back() - k.time.front()) * i / steps);
      s.value.push_back(fit.at(s.position.back()));
    }
    out_.series.push_back(std::move(s));
  }

  void refuse(const std::string& name, const Track& k, const TimeConstants& fit) {
    using Answer = TimeConstants::Answer;
    open_ = true;
    Finding f{.id = "",
              .attention = false,
              .evidence = {minutes("test_min", k.time.back() - k.time.front())},
              .texts = {{"sensor", name}}};
    switch (fit.answer) {
      case Answer::too_few:
        f.id = "thermal.too-few";
        f.evidence.push_back({"readings", static_cast<double>(k.size()), Quantity::count});
        break;
      case Answer::none:
        f.id = "thermal.no-time-constant";
        break;
      case Answer::too_short:
        f.id = "thermal.test-too-short";
        break;
      default: {
        f.id = "thermal.unresolved";
        const auto& worst = *std::max_element(
            fit.parts.begin(), fit.parts.end(),
            [](const auto& a, const auto& b) { return a.u_tau / a.tau < b.u_tau / b.tau; });
        f.evidence.push_back(minutes("tau_min", worst.tau));
        f.evidence.push_back(minutes("u_min", worst.u_tau));
        break;
      }
    }
    out_.findings.push_back(std::move(f));
  }

  void put_largest(const char* name, const std::vector<Item>& all) {
    const auto worst = std::max_element(all.begin(), all.end(), [](const Item& a, const Item& b) {
      return std::fabs(a.value) < std::fabs(b.value);
    });
    if (worst == all.end()) return;
    out_.items.push_back(*worst);
    out_.items.back().name = std::string(name) + "_" + m_.axis;
  }

  void exercised() {
    if (tracks_.visits.empty()) return once("thermal.too-few-cycles", {});
    std::vector<Item> whole, window, first, end;
    points();
    for (const auto& v : tracks_.visits) {
      Followed f;
      f.name = m_.axis;
      f.run = v.track;
      for (double& d : f.run.d) d -= v.track.d.front();
      const std::size_t before = out_.items.size();
      put_ranges(f);
      put_end(f, "end", f.run);
      for (std::size_t i = before; i < out_.items.size(); ++i) {
        Item item = out_.items[i];
        item.length = v.position;
        (item.name.starts_with("range")    ? whole
         : item.name.starts_with("window") ? window
         : item.name.starts_with("first")  ? first
                                           : end)
            .push_back(std::move(item));
      }
      out_.items.resize(before);
    }
    put_largest("range", whole), put_largest("window", window), put_largest("first", first);
    put_largest("end", end);
    put_growth();
    put_reversal();
  }

  void put_growth() {
    const Track g = math::growth(tracks_.visits);
    if (g.size() < 2) return once("thermal.one-target", {});
    double low = INFINITY, high = -INFINITY;
    double farthest = 0.0;
    for (const auto& v : tracks_.visits) {
      low = std::min(low, v.position), high = std::max(high, v.position);
      farthest = std::max(farthest, std::fabs(v.track.d.back() - v.track.d.front()));
    }
    const double L = high - low;
    // The target that moves most is beyond the travel where the fixed point is, and half of it where
    // this is in the middle.
    const double lever = g.d.back() != 0.0 ? farthest / std::fabs(g.d.back()) : L;
    const auto noise = math::reading_noise(g);
    out_.items.push_back({.name = "growth_" + m_.axis,
                          .value = g.d.back(),
                          .quantity = Quantity::deviation_per_length,
                          .u = std::numbers::sqrt2 * noise.s,
                          .dof = noise.dof,
                          .to = g.d.back() * L,
                          .scale = 1.0 / L,
                          .length = L});
    Series s{
        "growth_" + m_.axis, "t", Quantity::time, Quantity::deviation_per_length, g.time, g.d, {}};
    out_.series.push_back(std::move(s));
    const TimeConstants fit =
        put_constants(m_.axis, g, lever, Quantity::deviation_per_length, 1.0 / L, g.time.front());
    if (fit.answer == TimeConstants::Answer::resolved)
      propose_effect(fit, g.time.front(), low, high);
  }

  /// The equivalent warm-up effect of a machine model: w (p - fixed) (1 - exp(-t/tau)).
  void propose_effect(const TimeConstants& fit, double first, double low, double high) {
    if (fit.parts.size() != 1) return once("thermal.two-for-the-model", {});
    const auto& p = fit.parts.front();
    // Tracks are 0 at the first cycle, but the effect is 0 at the start of the exercise.
    const double before = std::exp(first / p.tau);
    double mean = 0.0, place = 0.0, n = 0.0;
    for (const auto& v : tracks_.visits)
      mean += v.track.d.back() - v.track.d.front(), place += v.position, n += 1.0;
    mean /= n, place /= n;
    const auto& time = tracks_.visits.front().track.time;
    const double slope = fit.at(time.back() - time.front()) - fit.d0;
    Finding f{.id = "thermal.for-the-model",
              .attention = false,
              .evidence = {{"w", before * p.c, Quantity::deviation_per_length},
                           {"u_w", before * p.u_c, Quantity::deviation_per_length},
                           {"tau", p.tau, Quantity::time},
                           {"u_tau", p.u_tau, Quantity::time},
                           minutes("tau_min", p.tau)},
              .texts = {{"effect", "warm-up:" + m_.axis}, {"axis", m_.axis}}};
    const double fixed = place - mean / slope;
    if (std::isfinite(fixed) && std::fabs(fixed) < 100.0 * (high - low) + std::fabs(high))
      f.evidence.push_back({"fixed", fixed, Quantity::length});
    out_.findings.push_back(std::move(f));
  }

  void put_reversal() {
    const Track r = math::reversal_change(tracks_.visits);
    const auto whole = math::whole_range(r);
    if (!whole || r.size() < 2) return;
    Followed f;
    f.name = m_.axis;
    out_.items.push_back(range_item("reversal", r, *whole, f));
    out_.series.push_back(
        {"reversal_" + m_.axis, "t", Quantity::time, Quantity::deviation, r.time, r.d, {}});
  }

  void points() {
    std::set<double> places;
    for (const auto& v : tracks_.visits) places.insert(v.position);
    PointTable::Column target{"target", Quantity::length, {places.begin(), places.end()}};
    out_.points.columns.push_back(std::move(target));
    for (const char* what : {"range", "end"})
      for (const int direction : {1, -1}) {
        PointTable::Column c{
            std::string(what) + (direction > 0 ? "+" : "-"), Quantity::deviation, {}};
        for (const double place : places) {
          double value = NAN;
          for (const auto& v : tracks_.visits)
            if (v.position == place && v.direction == direction)
              value = what[0] == 'e' ? v.track.d.back() - v.track.d.front()
                                     : math::whole_range(v.track)->range;
          c.values.push_back(value);
        }
        out_.points.columns.push_back(std::move(c));
      }
  }

  void settle() {
    const bool heats = tracks_.test == Test::spindle || tracks_.test == Test::axis;
    if (!heats || slowest_name_.empty()) return;
    out_.findings.push_back({.id = open_ ? "thermal.warm-up-at-least" : "thermal.warm-up-time",
                             .attention = false,
                             .evidence = {minutes("time_min", slowest_),
                                          minutes("U_min", 2.0 * slowest_u_),
                                          {"remaining", wish_.remaining, Quantity::deviation}},
                             .texts = {{"sensor", slowest_name_}}});
  }

  void once(const char* id, std::vector<Number> evidence) {
    if (!said_.insert(id).second) return;
    out_.findings.push_back({.id = id, .attention = false, .evidence = std::move(evidence)});
  }

  const Tracks& tracks_;
  const Measurement& m_;
  const Wish& wish_;
  Worked out_;
  std::set<std::string> said_, jumping_;
  double slowest_ = -1.0, slowest_u_ = 0.0;
  std::string slowest_name_;
  bool open_ = false;
};

Worked work(const Tracks& tracks, const Measurement& m, const Wish& wish) {
  return Worker(tracks, m, wish).run();
}

bool applies(const Campaign&, const Measurement& m) { return m.kind == "thermal"; }

/// Proposes environment.drift for the budgets of other campaigns from a machine at rest.
void propose_drift(const AnalysisInput& in, const Worked& worked, const Wish& wish,
                   Evaluation& out) {
  if (!(worked.drift > 0.0)) return;
  constexpr double of_range = 0.6;  // docs/dev/constants.md, A7
  Finding f{.id = "thermal.drift-proposal",
            .attention = false,
            .evidence = {{"drift", worked.drift, Quantity::deviation},
                         {"window_min", wish.window / 60.0, Quantity::number},
                         {"U_EVE", of_range * worked.drift, Quantity::deviation}},
            .texts = {{"sensor", worked.drift_sensor}, {"serial", in.campaign.machine.serial}}};
  const auto& stated = in.campaign.environment.drift;
  if (stated && worked.drift > *stated) {
    f.id = "thermal.drift-above-stated";
    f.attention = true;
    f.evidence.push_back({"stated", *stated, Quantity::deviation});
  }
  out.findings.push_back(std::move(f));
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.time.size() != o.size() ||
      !std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); }))
    return fail("measurement \"" + in.measurement.id + "\": expected a time with each reading");
  const Wish wish{in.options.number("window_min", 60.0) * 60.0,
                  in.options.number("remaining_um", 1.0) * 1e-6};
  const Tracks tracks = tracks_of(in.measurement, o);
  Worked worked = work(tracks, in.measurement, wish);
  Evaluation out;
  out.findings = std::move(worked.findings);
  math::put_differences(in.campaign, worked.items, out);
  out.series = std::move(worked.series);
  out.points = std::move(worked.points);
  propose_drift(in, worked, wish, out);
  const char* id = tracks.test == Test::etve      ? "method.thermal-etve"
                   : tracks.test == Test::loaded  ? "method.thermal-loaded"
                   : tracks.test == Test::spindle ? "method.thermal-spindle"
                                                  : "method.thermal-axis";
  out.notes.push_back({id, {{"window_min", wish.window / 60.0, Quantity::number}}});
  return out;
}

std::vector<Option> options() {
  return {within(0.1, 1e5,
                 {"window_min", 60.0, "min",
                  "Length of the windows in which ranges are taken: the time that a run of other "
                  "campaigns takes."}),
          within(0.001, 1e4,
                 {"remaining_um", 1.0, "um",
                  "Change that may remain after the warm-up that is proposed."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"thermal", "1.0.0",
            "Thermal tests (ISO 230-3): ranges in windows, time constants, growth, proposals.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::thermal
