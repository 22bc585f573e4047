// SPDX-License-Identifier: Apache-2.0
#include "causes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nonio/math/distributions.h"

namespace nonio::circle {

namespace {

using math::Cause;
using math::CauseFit;
using math::CircleModel;

constexpr double level = 0.01;  // significance level for a cyclic error
// Source: docs/dev/constants.md, A14.
constexpr double most_inflation = 1e4;  // of the variance; above it, columns are inseparable

const CauseFit::Value& of(const CauseFit& fit, Cause c) {
  return fit.of[static_cast<std::size_t>(c)];
}

/// Circular deviation of one direction (+1) due to the given causes after removal of their center.
double alone_of(const CircleModel& model, std::initializer_list<std::pair<Cause, double>> causes) {
  constexpr int points = 720;
  std::vector<double> r(points);
  double a = 0.0, b = 0.0;
  const auto angle = [](int i) { return (i + 0.5) * 2.0 * std::numbers::pi / points; };
  for (int i = 0; i < points; ++i) {
    for (const auto& [cause, size] : causes)
      r[static_cast<std::size_t>(i)] += size * math::cause_at(cause, model, angle(i), 1);
    a += r[static_cast<std::size_t>(i)] * std::cos(angle(i)) * 2.0 / points;
    b += r[static_cast<std::size_t>(i)] * std::sin(angle(i)) * 2.0 / points;
  }
  double low = INFINITY, high = -INFINITY;
  for (int i = 0; i < points; ++i) {
    const double x =
        r[static_cast<std::size_t>(i)] - a * std::cos(angle(i)) - b * std::sin(angle(i));
    low = std::min(low, x), high = std::max(high, x);
  }
  return high - low;
}

class Values {
 public:
  Values(const Circle& circle, const CircleModel& model, const CauseFit& fit, const Wish& wish,
         std::vector<Finding>& refused)
      : circle_(circle), model_(model), fit_(fit), wish_(wish), refused_(refused) {}

  std::vector<CauseValue> all() {
    scales();
    squareness_and_servo();
    for (std::size_t k = 0; k < 2; ++k) {
      const bool u = k == 0;
      const std::string& axis = circle_.axis[k];
      const auto& reversal = of(fit_, u ? Cause::reversal_u : Cause::reversal_v);
      plain(u ? Cause::reversal_u : Cause::reversal_v, "B_" + axis,
            reversal.value > 0.0 ? "circle.over-compensated" : "circle.lost-motion", axis);
      plain(u ? Cause::lateral_u : Cause::lateral_v, "lateral_" + axis, "circle.lateral-play",
            axis);
    }
    for (std::size_t k = 0; k < 2; ++k)
      plain(k == 0 ? Cause::bow_u : Cause::bow_v,
            "bow_E" + circle_.axis[1 - k].substr(0, 1) + circle_.axis[k].substr(0, 1), "circle.bow",
            circle_.axis[k]);
    for (std::size_t k = 0; k < 2; ++k) cyclic(k);
    if (!inseparable_.empty()) {
      std::string names;
      for (const std::string& name : inseparable_) names += (names.empty() ? "" : ", ") + name;
      refused_.push_back(
          {.id = "circle.inseparable", .attention = true, .texts = {{"names", names}}});
    }
    return std::move(out_);
  }

 private:
  bool separable(Cause c, const std::string& name) {
    const auto& v = of(fit_, c);
    if (!v.fitted && !model_.wanted[static_cast<std::size_t>(c)]) return false;
    if (v.fitted && v.inflation < most_inflation) return true;
    inseparable_.push_back(name);
    return false;
  }

  void put(Cause c, std::string name, std::string finding, std::string axis, double factor,
           Quantity quantity) {
    const auto& v = of(fit_, c);
    CauseValue out{std::move(name), std::move(finding),
                   std::move(axis), v.value * factor,
                   quantity,        v.u * std::fabs(factor),
                   v.by_bin,        alone_of(model_, {{c, v.value}})};
    for (double& d : out.by_bin) d *= factor;
    out_.push_back(std::move(out));
  }

  void plain(Cause c, const std::string& name, const char* finding, const std::string& axis) {
    if (separable(c, name)) put(c, name, finding, axis, 1.0, Quantity::deviation);
  }

  void scales() {
    if (separable(Cause::scale_mismatch, "scale_mismatch"))
      put(Cause::scale_mismatch, "scale_mismatch", "circle.scale-mismatch", "", 1.0,
          Quantity::deviation_per_length);
  }

  /// In readings of one direction, squareness and servo mismatch have the same column.
  void squareness_and_servo() {
    const auto [name, sign] = squareness_of(circle_);
    if (!circle_.both()) {
      refused_.push_back(
          {.id = "circle.one-direction", .attention = true, .texts = {{"name", name}}});
      return;
    }
    if (separable(Cause::squareness, name))
      put(Cause::squareness, name, "circle.squareness", "", sign, Quantity::small_angle);
    if (!wish_.feed || !(*wish_.feed > 0.0)) {
      refused_.push_back({.id = "circle.no-feed", .attention = false});
      return;
    }
    if (separable(Cause::servo_mismatch, "servo_mismatch"))
      put(Cause::servo_mismatch, "servo_mismatch", "circle.servo-mismatch", "", 1.0 / *wish_.feed,
          Quantity::time);
  }

  /// Cosine or sine component of a cyclic error, relative to the machine's zero. It is also
  /// reported if not significant, for the history.
  void waves(Cause c, std::string name) {
    const auto& v = of(fit_, c);
    out_.push_back({std::move(name), "", "", v.value, Quantity::deviation, v.u, v.by_bin, 0.0});
  }

  /// Reported only if significant, because noise also has an amplitude.
  void cyclic(std::size_t k) {
    const Cause sine = k == 0 ? Cause::cyclic_u_sin : Cause::cyclic_v_sin,
                cosine = k == 0 ? Cause::cyclic_u_cos : Cause::cyclic_v_cos;
    const std::string name = "cyclic_" + circle_.axis[k];
    if (!model_.wanted[static_cast<std::size_t>(sine)]) {
      refused_.push_back(
          {.id = "circle.no-pitch", .attention = false, .texts = {{"axis", circle_.axis[k]}}});
      return;
    }
    if (!separable(sine, name)) return;
    waves(cosine, "cyclicCos_" + circle_.axis[k]);
    waves(sine, "cyclicSin_" + circle_.axis[k]);
    const auto &a = of(fit_, sine), &b = of(fit_, cosine);
    const double c = std::hypot(a.value, b.value), u2 = (a.u * a.u + b.u * b.u) / 2.0;
    if (!(math::f_upper(c * c / 2.0 / u2, 2.0, fit_.dof) < level)) {
      refused_.push_back({.id = "circle.no-cyclic",
                          .attention = false,
                          .evidence = {{"seen", 3.0 * std::sqrt(u2), Quantity::deviation}},
                          .texts = {{"axis", circle_.axis[k]}}});
      return;
    }
    const double ca = a.value / c, cb = b.value / c;
    CauseValue out{name,
                   "circle.cyclic",
                   circle_.axis[k],
                   c,
                   Quantity::deviation,
                   std::sqrt(ca * ca * a.u * a.u + cb * cb * b.u * b.u +
                             2.0 * ca * cb * fit_.covariance(sine, cosine)),
                   a.by_bin,
                   alone_of(model_, {{sine, a.value}, {cosine, b.value}})};
    for (std::size_t i = 0; i < out.by_bin.size(); ++i)
      out.by_bin[i] = ca * a.by_bin[i] + cb * b.by_bin[i];
    out_.push_back(std::move(out));
  }

  const Circle& circle_;
  const CircleModel& model_;
  const CauseFit& fit_;
  const Wish& wish_;
  std::vector<Finding>& refused_;
  std::vector<CauseValue> out_;
  std::vector<std::string> inseparable_;
};

}  // namespace

std::pair<std::string, double> squareness_of(const Circle& circle) {
  const std::string plane = circle.axis[0].substr(0, 1) + circle.axis[1].substr(0, 1);
  if (plane == "XY") return {"C0Y", 1.0};
  if (plane == "YZ") return {"A0Z", 1.0};
  return {"B0Z", -1.0};  // ZX: a rotation of +Z towards +X reduces the angle
}

std::vector<CauseValue> cause_values(const Circle& circle, const CircleModel& model,
                                     const CauseFit& fit, const Wish& wish,
                                     std::vector<Finding>& refused) {
  return Values(circle, model, fit, wish, refused).all();
}

std::vector<math::CircleReading> Circle::of(int direction, std::uint32_t run) const {
  std::vector<math::CircleReading> out;
  for (const math::CircleReading& r : readings)
    if (r.run == run && (direction == 0 || r.direction == direction)) out.push_back(r);
  return out;
}

Expected<Circle> circle_of(const Measurement& m, const Observations& o) {
  Circle out;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    const bool first = to != m.to.end() && to->second != from;
    out.axis[first ? 0 : 1] = axis;
    out.centre[first ? 0 : 1] = from;
    if (first) out.R = to->second - from;
  }
  const std::size_t u = coordinate_of(out.axis[0]), v = coordinate_of(out.axis[1]);
  const auto *first = o.axis(out.axis[0]), *second = o.axis(out.axis[1]);
  if (u > 2 || v > 2 || !(out.R > 0.0) || first == nullptr || second == nullptr ||
      first->approach.size() != o.size() || second->approach.size() != o.size())
    return fail("expected readings of a circle, with its plane, radius and centre");
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto& n = o.sense_of(i);
    // The sign of n x (direction of travel) is the direction of rotation about the center.
    const double turn = n[u] * second->approach[i] - n[v] * first->approach[i];
    const int d = turn > 0.0 ? 1 : -1;
    double angle = std::atan2(n[v], n[u]);
    if (angle < 0.0) angle += 2.0 * std::numbers::pi;
    out.readings.push_back({angle, o.deviation[i], d, o.run_of(i)});
    (d > 0 ? out.plus : out.minus) = true;
  }
  std::vector<double> angles;
  for (const auto& r : out.readings)
    if (r.direction == out.readings.front().direction && r.run == out.readings.front().run)
      angles.push_back(r.angle);
  std::sort(angles.begin(), angles.end());
  std::vector<double> steps;
  for (std::size_t i = 1; i < angles.size(); ++i) steps.push_back(angles[i] - angles[i - 1]);
  if (!steps.empty()) {
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    out.step = 3.0 * steps[steps.size() / 2] + 1e-9;
  }
  return out;
}

double steady(double x, double size) {
  if (!(size > 0.0) || !std::isfinite(x)) return x;
  const double step = std::pow(10.0, std::floor(std::log10(size)) - 9.0);
  return std::round(x / step) * step;
}

}  // namespace nonio::circle
