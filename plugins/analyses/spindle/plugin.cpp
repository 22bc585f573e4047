// SPDX-License-Identifier: Apache-2.0
// Axes of rotation (ISO 230-7): error motions of a spindle from one sensor or several sensors.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nonio/math/differences.h"
#include "nonio/math/spindle.h"
#include "nonio/math/thermal.h"

namespace nonio::spindle {
namespace {

struct Place {
  double ball = 0.0, sensor = 0.0;  ///< orientations, rad, rounded to 0.001 deg
  auto operator<=>(const Place&) const = default;
};

struct SetUps {
  std::map<std::string, std::map<Place, math::Turns>> of;
  std::vector<Finding> findings;
  bool resampled = false;
};

/// Error separation by the orientations of one sensor: a pair with ball and sensor rotated by 180
/// deg, or the ball rotated in equal steps over 360 deg.
struct Separation {
  enum class Kind { none, donaldson, multi_step } kind = Kind::none;
  std::vector<Place> places;  ///< results are in the orientation of the first
};

constexpr double full = 2.0 * std::numbers::pi;
constexpr double grain = full / 360e3;  // 0.001 deg, in rad

/// Rounded to 0.001 deg within [0, 360 deg), in rad.
double rounded(double angle) {
  const double turned = std::fmod(std::fmod(angle, full) + full, full);
  const double steps = std::round(turned / grain);
  return steps >= 360e3 ? 0.0 : steps * grain;
}

bool same(double a, double b) { return std::fabs(std::remainder(a - b, full)) < 1.5 * grain; }

math::SpindleTrack track_of(const Observations& o, std::vector<std::size_t> rows) {
  const auto& angle = o.axes[0].position;
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return angle[a] < angle[b]; });
  math::SpindleTrack out;
  double n = 0.0;
  for (const std::size_t i : rows) {
    if (out.angle.empty() || angle[i] > out.angle.back()) {
      out.angle.push_back(angle[i]), out.r.push_back(0.0);
      n = 0.0;
    }
    n += 1.0;
    out.r.back() += (o.deviation[i] - out.r.back()) / n;
  }
  return out;
}

SetUps set_ups_of(const Observations& o) {
  SetUps out;
  if (o.axes.size() < 3) return out;
  std::vector<std::vector<std::size_t>> rows(o.lines.size());
  for (std::size_t i = 0; i < o.size(); ++i) rows[o.line_of(i)].push_back(i);
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    if (rows[line].empty()) continue;
    const std::string name = o.lines[line].name.substr(0, o.lines[line].name.find(' '));
    const std::size_t first = rows[line].front(), count = rows[line].size();
    const Place place{rounded(o.axes[1].position[first]), rounded(o.axes[2].position[first])};
    const math::SpindleTrack track = track_of(o, std::move(rows[line]));
    auto turns = math::turns_of(track);
    if (!turns) {
      out.findings.push_back(
          {.id = "spindle.refused-turns",
           .attention = true,
           .evidence = {{"readings", static_cast<double>(count), Quantity::count}},
           .texts = {{"sensor", o.lines[line].name}}});
      continue;
    }
    if (auto dead = math::dead_sensor(name, track.r)) {
      out.findings.push_back(*dead);
      continue;
    }
    out.resampled = out.resampled || turns->resampled;
    out.of[name].insert_or_assign(place, std::move(*turns));
  }
  return out;
}

Separation separation_of(const std::map<Place, math::Turns>& places) {
  Separation out;
  const double half = full / 2.0;
  for (const auto& [one, turns] : places)
    for (const auto& [two, other] : places)
      if (turns.n == other.n && same(one.ball + half, two.ball) &&
          same(one.sensor + half, two.sensor)) {
        out.kind = Separation::Kind::donaldson;
        out.places = {one, two};
        return out;
      }
  if (places.size() < 3) return out;
  std::size_t k = 0;
  const auto& [first, of_first] = *places.begin();
  const double step = full / static_cast<double>(places.size());
  for (const auto& [place, turns] : places) {
    if (turns.n != of_first.n || !same(place.sensor, first.sensor) ||
        !same(place.ball, first.ball + step * static_cast<double>(k)))
      return out;
    ++k;
    out.places.push_back(place);
  }
  out.kind = Separation::Kind::multi_step;
  return out;
}

using math::Difference;
using math::ErrorMotion;
using math::Turns;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "spindle"; }

struct Channel {
  std::string name;
  Turns turns;
  bool axial = false;
  double lever = 0.0;  ///< of a tilt: distance of the sensors, m; otherwise 0
  bool with_ball = true;
  double u_ball = 0.0;  ///< standard uncertainty of the form of the ball that was subtracted, m
};

class Worker {
 public:
  explicit Worker(const AnalysisInput& in) : in_(in), set_ups_(set_ups_of(in.observations)) {}

  Evaluation run() {
    out_.findings = set_ups_.findings;
    for (const auto& [name, places] : set_ups_.of) {
      if (name == "Z") {
        one({name, places.begin()->second, true, 0.0, false}, nullptr);
        continue;
      }
      const Separation how = separation_of(places);
      const bool none = how.kind == Separation::Kind::none;
      if (none && places.size() > 1)
        out_.findings.push_back(
            {.id = "spindle.set-ups-not-used",
             .attention = true,
             .evidence = {{"set_ups", static_cast<double>(places.size()), Quantity::count}},
             .texts = {{"sensor", name}}});
      one({name, first_of(places, how), false, 0.0, none}, &how);
    }
    both_directions();
    tilts();
    if (ball_) out_.findings.push_back({.id = "spindle.ball-in-values", .attention = false});
    math::put_differences(in_.campaign, items_, out_);
    out_.notes.push_back({"method.spindle"});
    if (set_ups_.resampled) out_.notes.push_back({"method.spindle-resampled"});
    return std::move(out_);
  }

 private:
  static const Turns& first_of(const std::map<Place, Turns>& places, const Separation& how) {
    return how.places.empty() ? places.begin()->second : places.at(how.places.front());
  }

  void put(const Channel& c, const char* name, double value, double u, double dof, double from,
           double to, bool ball) {
    const bool tilt = c.lever > 0.0;
    ball_ = ball_ || (ball && !in_.campaign.instrument.sphere);
    items_.push_back({.name = std::string(name) + "_" + c.name,
                      .value = tilt ? value / c.lever : value,
                      .quantity = tilt ? Quantity::small_angle : Quantity::deviation,
                      .u = tilt ? u / c.lever : u,
                      .dof = dof,
                      .from = from,
                      .to = to,
                      .scale = tilt ? 1.0 / c.lever : 1.0,
                      .with_ball = ball});
  }

  /// Range of a mean curve. Its uncertainty contains two readings and the bias of a range by noise.
  void put_synchronous(const Channel& c, const char* name, const std::vector<double>& curve,
                       double u_mean, double dof) {
    const auto [low, high] = std::minmax_element(curve.begin(), curve.end());
    const double excess = math::range_excess(curve, u_mean);
    put(c, name, *high - *low, std::sqrt(2.0 * u_mean * u_mean + excess * excess / 3.0), dof, *low,
        *high, c.with_ball);
  }

  void one(Channel c, const Separation* how) {
    std::vector<double> curve;
    double u_mean = 0.0;
    const bool separated = how != nullptr && how->kind != Separation::Kind::none;
    if (separated) separate(c, *how, curve, u_mean);
    const ErrorMotion e = math::error_motion(c.turns);
    const double half = e.total / 2.0, N = static_cast<double>(c.turns.N);
    // The total motion is defined for these revolutions only, so it has no repetition uncertainty.
    const double total = c.axial ? e.total_with_once : e.total;
    put(c, "total", total, std::numbers::sqrt2 * c.u_ball, e.dof, -total / 2.0, total / 2.0,
        c.with_ball && !c.axial);
    if (!separated) {
      curve = c.axial ? e.with_once : e.motion;
      u_mean = std::hypot(e.u_mean, c.u_ball);
    }
    put_synchronous(c, "sync", curve, u_mean, e.dof);
    put(c, "async", e.asynchronous, 0.0, INFINITY, -half, half, false);
    const double once = e.eccentricity();
    if (c.axial) {
      put(c, "fundamental", e.fundamental(), 2.0 * e.u_ab, e.dof, 0.0, e.fundamental(), false);
      put_synchronous(c, "rest", e.motion, e.u_mean, e.dof);
    } else if (c.lever == 0.0 && c.name != "R") {
      put(c, "eccentricity", once, e.u_ab, e.dof, 0.0, once, false);
    }
    waves(c, curve, u_mean);
    put_curve(c, curve);
    constexpr double few = 20.0;  // docs/dev/constants.md, A18
    if (N < few && !few_turns_) {
      few_turns_ = true;
      out_.findings.push_back({.id = "spindle.few-turns",
                               .attention = false,
                               .evidence = {{"turns", N, Quantity::count}}});
    }
  }

  /// Returns in `curve` the spindle motion without the form error of the ball, subtracts the form
  /// error from the readings, and adds it as a result.
  void separate(Channel& c, const Separation& how, std::vector<double>& curve, double& u_mean) {
    const auto& places = set_ups_.of.at(c.name);
    std::vector<std::vector<double>> curves;
    double squares = 0.0;
    for (const auto& place : how.places) {
      const ErrorMotion e = math::error_motion(places.at(place));
      curves.push_back(e.motion);
      squares += e.u_mean * e.u_mean;
    }
    const double K = static_cast<double>(curves.size());
    const math::Separated s = how.kind == Separation::Kind::donaldson
                                  ? math::donaldson(curves[0], curves[1])
                                  : math::multi_step(curves);
    curve = s.spindle;
    u_mean = std::sqrt(squares) / K;
    put_synchronous(c, "ball", s.ball, u_mean, 2.0 * K);
    for (std::size_t i = 0; i < c.turns.r.size(); ++i) c.turns.r[i] -= s.ball[i % c.turns.n];
    c.u_ball = u_mean;
    freed_.insert_or_assign(c.name, c);
    if (how.kind == Separation::Kind::multi_step)
      out_.findings.push_back({.id = "spindle.multi-step-leaves",
                               .attention = false,
                               .evidence = {{"steps", K, Quantity::count}},
                               .texts = {{"sensor", c.name}}});
    else
      out_.findings.push_back(
          {.id = "spindle.reversal", .attention = false, .texts = {{"sensor", c.name}}});
  }

  /// Reports the largest harmonic of the synchronous motion, because its order indicates the cause.
  void waves(const Channel& c, const std::vector<double>& curve, double u_mean) {
    constexpr int most = 64;
    const auto n = static_cast<double>(curve.size());
    double best = 0.0, all = 0.0;
    int order = 0;
    for (const double v : curve) all += v * v / n;
    for (int k = c.axial ? 1 : 2; k <= std::min(most, static_cast<int>(n) / 3); ++k) {
      double a = 0.0, b = 0.0;
      for (std::size_t i = 0; i < curve.size(); ++i) {
        const double t = 2.0 * std::numbers::pi * k * static_cast<double>(i) / n;
        a += 2.0 / n * curve[i] * std::cos(t), b += 2.0 / n * curve[i] * std::sin(t);
      }
      if (const double size = std::hypot(a, b); size > best) best = size, order = k;
    }
    constexpr double large_share = 0.5;  // docs/dev/constants.md, A19
    if (order == 0 || !(best * best / 2.0 > large_share * all) ||
        !(best > 4.0 * u_mean * std::sqrt(2.0 / n)))
      return;
    const double lever = c.lever > 0.0 ? 1.0 / c.lever : 1.0;
    out_.findings.push_back(
        {.id = "spindle.wave",
         .attention = false,
         .evidence = {{"waves", static_cast<double>(order), Quantity::count},
                      {"amplitude", best * lever,
                       c.lever > 0.0 ? Quantity::small_angle : Quantity::deviation},
                      {"share", best * best / 2.0 / all, Quantity::ratio}},
         .texts = {{"name", c.name}}});
  }

  void put_curve(const Channel& c, const std::vector<double>& curve) {
    const bool tilt = c.lever > 0.0;
    Series s{"sync_" + c.name,
             "S",
             Quantity::angle,
             tilt ? Quantity::small_angle : Quantity::deviation,
             {},
             {},
             {}};
    const std::size_t step = curve.size() / 720 + 1;
    for (std::size_t i = 0; i < curve.size(); i += step) {
      s.position.push_back(c.turns.angle(i));
      s.value.push_back(tilt ? curve[i] / c.lever : curve[i]);
    }
    out_.series.push_back(std::move(s));
  }

  const Turns* first(const char* name) const {
    const auto found = set_ups_.of.find(name);
    return found == set_ups_.of.end() ? nullptr : &found->second.begin()->second;
  }

  /// Rotating sensitive direction, from two sensors at 90 deg in the plane nearest to the spindle
  /// nose.
  void both_directions() {
    for (const auto& [x, y] : {std::pair{"X", "Y"}, {"X1", "Y1"}}) {
      const Turns *X = first(x), *Y = first(y);
      if (X == nullptr || Y == nullptr) continue;
      const bool freed = freed_.contains(x) && freed_.contains(y);
      if (freed) X = &freed_.at(x).turns, Y = &freed_.at(y).turns;
      const int sense = math::sense_of(math::error_motion(*X), math::error_motion(*Y));
      auto R = math::rotating(*X, *Y, sense == 0 ? 1 : sense);
      if (!R) continue;
      out_.findings.push_back({.id = sense > 0   ? "spindle.sense-x-to-y"
                                     : sense < 0 ? "spindle.sense-y-to-x"
                                                 : "spindle.sense-not-known",
                               .attention = sense == 0});
      const double u = freed ? std::max(freed_.at(x).u_ball, freed_.at(y).u_ball) : 0.0;
      return one({"R", std::move(*R), false, 0.0, !freed, u}, nullptr);
    }
    if (!set_ups_.of.empty())
      out_.findings.push_back({.id = "spindle.fixed-only", .attention = false});
  }

  void tilts() {
    for (const auto& [name, one_name, two_name, axis] :
         {std::tuple{"B", "X1", "X2", "X"}, {"A", "Y1", "Y2", "Y"}}) {
      const Turns *near = first(one_name), *far = first(two_name);
      if (near == nullptr || far == nullptr || near->n != far->n || near->N != far->N) continue;
      if (!in_.measurement.foot) {
        out_.findings.push_back(
            {.id = "spindle.no-tilt", .attention = false, .texts = {{"axis", axis}}});
        continue;
      }
      Channel c{name, *near, false, *in_.measurement.foot, true};
      for (std::size_t i = 0; i < c.turns.r.size(); ++i) c.turns.r[i] -= far->r[i];
      one(c, nullptr);
    }
  }

  const AnalysisInput& in_;
  SetUps set_ups_;
  std::vector<Difference> items_;
  Evaluation out_;
  std::map<std::string, Channel> freed_;  ///< sensors whose readings no longer contain the ball
  bool ball_ = false, few_turns_ = false;
};

Expected<Evaluation> analyse(const AnalysisInput& in) { return Worker(in).run(); }

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"spindle",
            "1.0.0",
            "Axes of rotation (ISO 230-7): total, synchronous and asynchronous error motion, tilt, "
            "reversal.",
            {}};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::spindle
