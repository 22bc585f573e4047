// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulate_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace nonio::simulation {

namespace {

double material(const TemperatureCourse& c, double t) {
  const double swing = c.swing * std::sin(2.0 * std::numbers::pi * t / c.period);
  return std::round((c.start + c.drift * t + swing) * 100.0) / 100.0;
}

struct Side {
  std::string axis;
  std::size_t coordinate = 0;
  double from = 0.0, slope = 0.0;
};

Expected<std::vector<Side>> sides_of(const Measurement& m) {
  std::vector<Side> sides;
  double square = 0.0;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    const std::size_t k = coordinate_of(axis);
    if (to == m.to.end() || k > 2)
      return fail("measurement \"" + m.id + "\": expected `from` and `to` of X, Y and Z");
    if (to->second == from) continue;
    sides.push_back({axis, k, from, to->second - from});
    square += (to->second - from) * (to->second - from);
  }
  if (sides.size() < 2)
    return fail("measurement \"" + m.id +
                "\": expected `from` and `to` to differ in at least two axes");
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.coordinate < b.coordinate; });
  for (Side& side : sides) side.slope /= std::sqrt(square);
  return sides;
}

template <class Put>
void sweep(const CycleSpec& c, const std::vector<double>& targets, Clock& clock, Put put) {
  const auto pass = [&](std::uint32_t run, double direction) {
    for (std::size_t k = 0; k < targets.size(); ++k)
      put(targets[direction > 0.0 ? k : targets.size() - 1 - k],
          direction > 0.0 ? std::int8_t{1} : std::int8_t{-1}, run);
  };
  for (std::uint32_t run = 1; run <= c.runs; ++run) {
    if (run > 1) clock.pause();
    pass(run, c.direction);
    if (c.pendulum) pass(run, -c.direction);
  }
}

Expected<Observations> along(const Specification& s, const CycleSpec& c,
                             const std::vector<double>& targets) {
  Observations o;
  o.measurement = c.measurement.id;
  o.angular = c.along_axis() && c.axis.rotary;
  o.structure = s.campaign.machine.structure;
  std::vector<Side> sides{{c.axis.name, 0, 0.0, 1.0}};
  std::array<double, 3> sense{c.axis.rotary ? 0.0 : 1.0, 0.0, 0.0};
  if (const std::size_t k = coordinate_of(c.axis.name);
      !c.axis.rotary && k < 3 && !c.is("diagonal"))
    sense = {}, sense[k] = 1.0;
  if (c.is("straightness") || (c.method != nullptr && !c.measurement.lateral.empty())) {
    const std::size_t k = coordinate_of(c.measurement.lateral);
    if (k > 2) return fail("measurement \"" + c.measurement.id + "\": expected lateral X, Y or Z");
    sense = {}, sense[k] = 1.0;
  }
  if (c.is("diagonal")) {
    NONIO_TRY(auto found, sides_of(c.measurement));
    sides = std::move(found);
    sense = {};
    for (const Side& side : sides) sense[side.coordinate] = side.slope;
  }
  o.lines.push_back({c.measurement.id, sense});
  for (const Side& side : sides) o.axes.push_back({side.axis, c.axis.rotary, {}, {}});
  Clock clock(c);
  double last = 0.0;
  sweep(c, targets, clock, [&](double at, std::int8_t direction, std::uint32_t run) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      o.axes[k].position.push_back(sides[k].from + sides[k].slope * at);
      o.axes[k].approach.push_back(sides[k].slope < 0.0 ? static_cast<std::int8_t>(-direction)
                                                        : direction);
    }
    o.run.push_back(run);
    o.line.push_back(0);
    o.deviation.push_back(c.is("straightness") ? c.set_up * at : 0.0);
    clock.reading(o, std::fabs(at - last));
    last = at;
  });
  return o;
}

Expected<Observations> in_steps(const Specification& s, const CycleSpec& c) {
  NONIO_TRY(const auto sides, sides_of(c.measurement));
  if (sides.size() != 3)
    return fail("measurement \"" + c.measurement.id +
                "\": expected `from` and `to` to differ in X, Y and Z");
  Observations o;
  o.measurement = c.measurement.id;
  o.structure = s.campaign.machine.structure;
  for (const Side& side : sides) o.axes.push_back({side.axis, false, {}, {}});
  static constexpr std::array<std::pair<const char*, std::array<double, 3>>, 4> corners{
      {{"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}};
  Clock clock(c);
  for (std::uint32_t run = 1; run <= c.runs; ++run)
    for (const auto& [name, sign] : corners) {
      if (!o.lines.empty()) clock.pause();
      Observations::Line line{
          c.measurement.id + " " + name + (run == 1 ? "" : " run " + std::to_string(run)), {}};
      for (std::size_t k = 0; k < 3; ++k) line.sense[k] = sign[k] * sides[k].slope;
      o.lines.push_back(line);
      // Step 0 is the position where the display is set to 0; the file does not contain it.
      for (std::uint32_t step = 0; step <= 3 * c.steps; ++step) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Side& side = sides[k];
          const double whole = c.measurement.to.at(side.axis) - side.from;
          const std::uint32_t moved = (step + 2 - static_cast<std::uint32_t>(k)) / 3;
          o.axes[k].position.push_back((sign[k] > 0.0 ? side.from : side.from + whole) +
                                       sign[k] * whole * moved / c.steps);
          o.axes[k].approach.push_back(sign[k] * whole > 0.0 ? 1 : -1);
        }
        const std::size_t moving = (step + 2) % 3;
        o.run.push_back(run);
        o.line.push_back(static_cast<std::uint32_t>(o.lines.size() - 1));
        o.deviation.push_back(0.0);
        clock.reading(
            o, std::fabs(c.measurement.to.at(sides[moving].axis) - sides[moving].from) / c.steps);
      }
    }
  return o;
}

/// Each run is in the specified direction, and then, if `pendulum`, in the opposite one. Lines have
/// the names that the reader of the file uses. No reading is exactly at a reversal.
Expected<Observations> on_circle(const CycleSpec& c) {
  Observations o;
  o.measurement = c.measurement.id;
  std::array<std::string, 2> axis;
  std::array<double, 2> centre{};
  double radius = 0.0;
  for (const auto& [name, from] : c.measurement.from) {
    const double way = c.measurement.to.at(name) - from;
    const std::size_t k = way != 0.0 ? 0 : 1;
    axis[k] = name, centre[k] = from;
    if (k == 0) radius = way;
  }
  const std::size_t u = coordinate_of(axis[0]), v = coordinate_of(axis[1]);
  if (u > 2 || v > 2 || !(radius > 0.0))
    return fail("measurement \"" + c.measurement.id +
                "\": expected `plane`, `radius_mm` and `centre` of the circle");
  o.axes = {{axis[0], false, {}, {}}, {axis[1], false, {}, {}}};
  const double step = 2.0 * std::numbers::pi / c.readings;
  const auto way_of = [](double speed) { return speed > 0.0 ? std::int8_t{1} : std::int8_t{-1}; };
  Clock clock(c);
  for (std::uint32_t run = 1; run <= c.runs; ++run)
    for (const double d : {c.direction, -c.direction}) {
      if (d != c.direction && !c.pendulum) continue;
      if (!o.lines.empty()) clock.pause();
      for (std::uint32_t j = 0; j < c.readings; ++j) {
        const double t = step * ((d > 0.0 ? j : c.readings - 1 - j) + 0.5), x = std::cos(t),
                     y = std::sin(t);
        o.axes[0].position.push_back(centre[0] + radius * x);
        o.axes[1].position.push_back(centre[1] + radius * y);
        o.axes[0].approach.push_back(way_of(-d * y));
        o.axes[1].approach.push_back(way_of(d * x));
        std::array<double, 3> sense{};
        sense[u] = x, sense[v] = y;
        o.sense.push_back(sense);
        o.run.push_back(run);
        o.line.push_back(static_cast<std::uint32_t>(o.lines.size()));
        o.deviation.push_back(0.0);
        clock.reading(o, radius * step);
      }
      o.lines.push_back({c.measurement.id + (d > 0.0 ? " +" : " -") +
                             (run == 1 ? "" : " run " + std::to_string(run)),
                         o.sense.back()});
      o.lines.back().feed = c.feed;
    }
  return o;
}

/// Adds the slope measured against the square of the measurement: on the line of the first axis the
/// setup angle, on the line of the other axis the error of the square (negative if it was reversed)
/// minus the setup angle (math/square.h: b1 + b2 = t + g).
void put_square(const Specification& s, const CycleSpec& c, Observations& o) {
  for (const SquareSpec& q : s.squares) {
    if (q.name != c.measurement.square) continue;
    const bool first = coordinate_of(c.axis.name) < coordinate_of(c.measurement.lateral);
    const double error = c.measurement.square_turned ? -q.error : q.error,
                 slope = first ? q.set_up : error - q.set_up;
    for (std::size_t i = 0; i < o.size(); ++i) o.deviation[i] += slope * o.axes[0].position[i];
  }
}

}  // namespace

void Clock::reading(Observations& o, double way) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!first_) t_ += way / c_.feed + c_.dwell;
  first_ = false;
  const double ticks = c_.is("circle") ? 1000.0 : 10.0;  // resolution of the times, 1/s
  o.time.push_back(c_.timed ? std::round(t_ * ticks) / ticks : unknown);
  o.material.push_back(c_.temperature ? material(*c_.temperature, t_) : unknown);
}

Expected<Observations> rows_of(const Specification& s, const CycleSpec& c,
                               const std::vector<double>& targets) {
  if (c.is("ball-centres") || c.is("rtcp")) {
    CycleSpec with = c;
    with.targets = targets;
    return rotary_rows(s, with);
  }
  if (c.is("circle")) return on_circle(c);
  if (c.is("step-diagonal")) return in_steps(s, c);
  auto o = along(s, c, targets);
  if (o && c.is("straightness")) put_square(s, c, *o);
  return o;
}

}  // namespace nonio::simulation
