// SPDX-License-Identifier: Apache-2.0
// Cases of heat: `given NAME x x x`, a list for each line of that name.
//
//   thermal [window_min=W]   step_min, readings (um); or curve d0 c tau c tau (um, min), readings n
//   spindle [axial]          turns, n; wave ORDER AMPLITUDE PHASE (um, rad, orders a turn, also broken)
//   reversal-of-ball         the same waves for the spindle; ball ORDER AMPLITUDE PHASE
//   multi-step steps=K       the same
//   lengths [edition=2001]   limit A K B (um, L in mm); U; error POSITION LENGTH_mm ERROR_um REPEAT [U]
//   sphere                   point x y z (mm)
#include "heat.h"

#include <cmath>
#include <numbers>

#include "nonio/math/lengths.h"
#include "nonio/math/spindle.h"
#include "nonio/math/thermal.h"

namespace {

using namespace nonio::math;
using Lists = std::vector<std::vector<double>>;

constexpr double um = 1e-6, mm = 1e-3, minute = 60.0;

const Lists& lists(const Case& c, const std::string& name) {
  static const Lists none;
  const auto found = c.lists.find(name);
  return found == c.lists.end() ? none : found->second;
}

double number(const Case& c, const std::string& name, double otherwise = 0.0) {
  const Lists& all = lists(c, name);
  return all.empty() || all.front().empty() ? otherwise : all.front().front();
}

double option(const Case& c, const std::string& name, double otherwise) {
  const auto found = c.options.find(name);
  return found == c.options.end() ? otherwise : std::stod(found->second);
}

Track track_of(const Case& c) {
  Track k;
  const double step = number(c, "step_min", 1.0) * minute;
  const Lists& curve = lists(c, "curve");
  const auto n = static_cast<int>(number(c, "count"));
  if (!curve.empty()) {
    const auto& p = curve.front();
    for (int i = 0; i < n; ++i) {
      double d = p[0];
      for (std::size_t q = 1; q + 1 < p.size(); q += 2)
        d += p[q] * (1.0 - std::exp(-i * step / (p[q + 1] * minute)));
      k.time.push_back(i * step), k.d.push_back(d * um);
    }
  } else if (!lists(c, "readings").empty()) {
    for (const double d : lists(c, "readings").front())
      k.time.push_back(step * static_cast<double>(k.time.size())), k.d.push_back(d * um);
  }
  return k;
}

Outcome of_thermal(const Case& c) {
  Outcome out;
  const Track k = track_of(c);
  const double w = option(c, "window_min", 60.0) * minute;
  if (const auto r = whole_range(k)) out.values["range"] = r->range / um;
  if (const auto r = first_range(k, w)) out.values["first"] = r->range / um;
  if (const auto r = largest_range(k, w)) {
    out.values["window"] = r->range / um;
    out.values["window_from"] = r->from / minute, out.values["window_to"] = r->to / minute;
  }
  const auto noise = reading_noise(k);
  if (noise.dof > 0.0) out.values["s"] = noise.s / um;
  const auto fit = time_constants(k);
  static constexpr const char* answers[] = {"resolved", "too_few", "none", "too_short",
                                            "unresolved"};
  out.words["answer"] = answers[static_cast<int>(fit.answer)];
  if (fit.answer != TimeConstants::Answer::resolved) return out;
  for (std::size_t i = 0; i < fit.parts.size(); ++i) {
    const std::string which = i == 0 ? "" : "2";
    out.values["tau" + which] = fit.parts[i].tau / minute;
    out.values["c" + which] = fit.parts[i].c / um;
  }
  out.values["settled"] = fit.settled(number(c, "remaining", 1.0) * um).t / minute;
  return out;
}

double sum_of(const Lists& waves, double turns) {
  double r = 0.0;
  for (const auto& w : waves)
    r += w[1] * um * std::cos(2.0 * std::numbers::pi * w[0] * turns + w[2]);
  return r;
}

/// with: how much of the ball, turned by `ball` turns, is added to `sign` times the spindle.
Turns turns_for(const Case& c, double sign = 1.0, double ball = 0.0, bool other_side = false) {
  SpindleTrack k;
  const double n = number(c, "n", 64.0);
  const auto count = static_cast<int>(std::floor(number(c, "turns", 4.0) * n + 0.5));
  for (int i = 0; i < count; ++i) {
    const double t = i / n;
    k.angle.push_back(2.0 * std::numbers::pi * t);
    // The sensor shows the ball's profile at the sensor's angle less the angle of spindle and ball.
    k.r.push_back(sign * sum_of(lists(c, "wave"), t) +
                  sum_of(lists(c, "ball"), (other_side ? 0.5 : 0.0) - t - ball));
  }
  const auto out = turns_of(k);
  return out ? *out : Turns{};
}

Outcome of_spindle(const Case& c) {
  Outcome out;
  const Turns turns = turns_for(c);
  if (turns.N == 0) {
    out.words["answer"] = "no_turns";
    return out;
  }
  out.words["answer"] = "turns";
  const ErrorMotion e = error_motion(turns);
  out.values["n"] = static_cast<double>(turns.n),
  out.values["turns"] = static_cast<double>(turns.N);
  out.values["eccentricity"] = e.eccentricity() / um;
  out.values["total"] = (c.options.contains("axial") ? e.total_with_once : e.total) / um;
  out.values["synchronous"] =
      (c.options.contains("axial") ? e.synchronous_with_once : e.synchronous) / um;
  out.values["asynchronous"] = e.asynchronous / um;
  out.values["fundamental"] = e.fundamental() / um;
  out.values["residual"] = e.synchronous / um;
  return out;
}

Outcome of_separation(const Case& c) {
  Outcome out;
  Separated s;
  if (c.analysis == "reversal-of-ball") {
    s = donaldson(error_motion(turns_for(c)).motion,
                  error_motion(turns_for(c, -1.0, 0.5, true)).motion);
  } else {
    std::vector<std::vector<double>> all;
    const int K = static_cast<int>(option(c, "steps", 4.0));
    for (int k = 0; k < K; ++k)
      all.push_back(error_motion(turns_for(c, 1.0, static_cast<double>(k) / K)).motion);
    s = multi_step(all);
  }
  out.values["spindle"] = range_of(s.spindle) / um, out.values["ball"] = range_of(s.ball) / um;
  return out;
}

Outcome of_lengths(const Case& c) {
  Outcome out;
  const auto& limits = lists(c, "limit");
  LengthLimit limit;
  if (!limits.empty()) limit = {limits[0][0] * um, limits[0][1] * mm / um, limits[0][2] * um};
  if (const double at = number(c, "at"); at > 0.0) out.values["mpe"] = limit.at(at * mm) / um;
  std::vector<LengthError> errors;
  for (const auto& e : lists(c, "error"))
    errors.push_back(
        {e[1] * mm, e[2] * um, static_cast<std::uint32_t>(e[3]), static_cast<std::size_t>(e[0])});
  if (errors.empty()) return out;
  const auto it = c.options.find("edition");
  std::vector<double> U;
  for (const auto& e : lists(c, "error")) U.push_back((e.size() > 4 ? e[4] : number(c, "U")) * um);
  const auto answer =
      judge_lengths(errors, limit, U, it != c.options.end() && it->second == "2001");
  static constexpr const char* decisions[] = {"conforms", "does_not_conform", "cannot_be_decided"};
  out.words["answer"] = decisions[static_cast<int>(answer.decision)];
  out.values["outside"] = static_cast<double>(answer.outside);
  out.values["undecided"] = static_cast<double>(answer.undecided);
  out.values["to_repeat"] = static_cast<double>(answer.to_repeat);
  out.values["worst"] = errors[answer.worst].E / um;
  if (const auto r = repeat_range(errors)) out.values["R0"] = r->range / um;
  const auto plan = length_plan(errors);
  out.values["positions"] = static_cast<double>(plan.positions);
  out.values["lengths"] = static_cast<double>(plan.lengths);
  out.values["repeats"] = static_cast<double>(plan.repeats);
  return out;
}

Outcome of_sphere(const Case& c) {
  Outcome out;
  std::vector<std::array<double, 3>> points;
  for (const auto& p : lists(c, "point")) points.push_back({p[0] * mm, p[1] * mm, p[2] * mm});
  if (const auto f = form_of_sphere(points)) {
    out.values["P"] = f->P / um, out.values["radius"] = f->radius / mm;
    out.values["x"] = f->centre[0] / mm;
  }
  return out;
}

}  // namespace

bool is_heat(const Case& c) {
  for (const char* name :
       {"thermal", "spindle", "reversal-of-ball", "multi-step", "lengths", "sphere"})
    if (c.analysis == name) return true;
  return false;
}

Outcome evaluate_heat(const Case& c) {
  if (c.analysis == "thermal") return of_thermal(c);
  if (c.analysis == "spindle") return of_spindle(c);
  if (c.analysis == "lengths") return of_lengths(c);
  if (c.analysis == "sphere") return of_sphere(c);
  return of_separation(c);
}
