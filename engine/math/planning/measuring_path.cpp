// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/measuring_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace nonio::math {

namespace {

constexpr double nearly_one = 1.0 + 1e-9;  // tolerance against rounding before truncation

/// Uniform in [0, 1); distributions of the standard library differ between implementations.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

double rounded(double value, const AxisTargets& wish) {
  const double nearest = std::round(value / wish.resolution) * wish.resolution;
  const double slack = 1e-6 * wish.resolution;
  if (nearest < wish.first - slack) return nearest + wish.resolution;
  return nearest > wish.last + slack ? nearest - wish.resolution : nearest;
}

/// `before` and `after`: points of reversal.
std::vector<MeasuringMove> to_and_fro(const std::vector<std::vector<double>>& stops,
                                      const std::vector<double>& before,
                                      const std::vector<double>& after,
                                      const MeasuringRequest& wish) {
  std::vector<MeasuringMove> moves{{before}};
  for (int run = 0; run < wish.runs; ++run) {
    for (const auto& stop : stops) moves.push_back({stop, wish.dwell});
    if (wish.over_travel > 0.0 && wish.both_directions) moves.push_back({after});
    if (wish.both_directions)
      for (auto stop = stops.rbegin(); stop != stops.rend(); ++stop)
        moves.push_back({*stop, wish.dwell});
    if (wish.over_travel > 0.0 || !wish.both_directions) moves.push_back({before});
  }
  return moves;
}

MeasuringPath line_path(std::string name, const Rectangle& r, double y0, double step_x,
                        double step_y, int steps, const MeasuringRequest& wish) {
  MeasuringPath path{std::move(name), {r.x, r.y}, {false, false}, {}};
  const double further = std::max(std::fabs(step_x), std::fabs(step_y));
  const auto at = [&](double i) { return std::vector{r.from_x + i * step_x, y0 + i * step_y}; };
  std::vector<std::vector<double>> stops;
  for (int i = 0; i <= steps; ++i) stops.push_back(at(i));
  // Point beyond a stop, at integer multiples of the resolution, not further than requested.
  const auto beyond = [&](int stop, double direction) {
    std::vector<double> place = at(stop);
    const double multiple = direction * wish.over_travel / further / wish.resolution;
    place[0] += std::trunc(multiple * step_x * nearly_one) * wish.resolution;
    place[1] += std::trunc(multiple * step_y * nearly_one) * wish.resolution;
    return place;
  };
  path.moves = to_and_fro(stops, beyond(0, -1.0), beyond(steps, 1.0), wish);
  return path;
}

MeasuringPath step_path(const std::string& name, const Volume& v, const MeasuringRequest& wish) {
  MeasuringPath path{name, v.axes, std::vector(3, false), {}};
  std::vector<double> start(3), sign(3);
  for (std::size_t a = 0; a < 3; ++a) {
    sign[a] = name[a] == 'P' ? 1.0 : -1.0;
    start[a] = v.from[a] + (sign[a] > 0.0 ? 0.0 : v.n * v.step[a]);
  }
  std::vector<double> before = start;
  for (std::size_t a = 0; a < 3; ++a) before[a] -= sign[a] * wish.over_travel;
  path.moves.push_back({before});
  for (int run = 0; run < wish.runs; ++run) {
    path.moves.push_back({start, wish.dwell});
    std::vector<double> at = start;
    for (int i = 1; i <= v.n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        at[a] = start[a] + sign[a] * i * v.step[a];
        path.moves.push_back({at, wish.dwell});
      }
    path.moves.push_back({before});
  }
  return path;
}

}  // namespace

namespace {

// Rounds up; the bound applies to very large lengths, for which no measurement exists.
int whole_points(double count) {
  constexpr double most = 1e9;
  return static_cast<int>(std::min(most, std::ceil(count - 1e-9)));
}

}  // namespace

int axis_points(double length) {
  const double intervals = length > 2.0 ? length / 0.25 : 5.0 * length - 1.0;
  return std::max(5, 1 + whole_points(intervals));
}

int rotary_points(double angle) {
  constexpr double close = 1e-6;
  const double quarter = std::numbers::pi / 2.0;
  if (angle > 4.0 * quarter + close) return whole_points(2.0 * angle / quarter);
  return angle <= quarter + close ? 3 : angle <= 2.0 * quarter + close ? 5 : 8;
}

std::vector<double> cardinal_angles(double first, double last) {
  constexpr double close = 1e-9;
  const double quarter = std::numbers::pi / 2.0;
  std::vector<double> angles;
  for (double k = std::ceil((first - close) / quarter); k * quarter <= last + close; ++k)
    angles.push_back(k * quarter);
  return angles;
}

Expected<std::vector<double>> axis_targets(const AxisTargets& wish) {
  const double interval = (wish.last - wish.first) / (wish.points - 1);
  if (wish.points < 2 || !(interval > 2.0 * wish.resolution))
    return fail("the targets would lie closer than twice the resolution of the control");
  const double known = wish.period > 0.0 ? wish.period : interval;
  const double reach = wish.scatter ? std::min(known, 0.3 * interval) : 0.0;
  std::mt19937_64 random(wish.seed);
  std::vector<double> targets;
  for (int i = 0; i < wish.points; ++i) {
    const double even = wish.first + i * interval;
    const double offset = reach * (2.0 * uniform(random) - 1.0);
    const double inwards = i == 0                 ? std::fabs(offset)
                           : i == wish.points - 1 ? -std::fabs(offset)
                                                  : offset;
    targets.push_back(rounded(even + inwards, wish));
  }
  for (const double place : wish.among)
    *std::min_element(targets.begin(), targets.end(), [&](double a, double b) {
      return std::fabs(a - place) < std::fabs(b - place);
    }) = place;
  return targets;
}

MeasuringPath axis_path(const std::string& axis, bool rotary, const std::vector<double>& targets,
                        const MeasuringRequest& wish) {
  std::vector<std::vector<double>> stops;
  for (const double t : targets) stops.push_back({t});
  return {axis,
          {axis},
          {rotary},
          to_and_fro(stops, {targets.front() - wish.over_travel},
                     {targets.back() + wish.over_travel}, wish)};
}

MeasuringPath probe_path(const std::string& axis, bool rotary, double start, double from, double to,
                         const MeasuringRequest& wish) {
  return {"sign-probe-" + axis,
          {axis},
          {rotary},
          {{{start}}, {{from}, wish.dwell, true}, {{to}, wish.dwell, true}}};
}

std::vector<MeasuringPath> diagonal_paths(const Rectangle& r, const MeasuringRequest& wish) {
  return {line_path("D1", r, r.from_y, r.step_x, r.step_y, r.n, wish),
          line_path("D2", r, r.from_y + r.n * r.step_y, r.step_x, -r.step_y, r.n, wish)};
}

MeasuringPath half_diagonal_path(const Rectangle& r, const MeasuringRequest& wish) {
  return line_path("D3", r, r.from_y, 2.0 * r.step_x, r.step_y, r.n / 2, wish);
}

std::vector<MeasuringPath> step_diagonal_paths(const Volume& v, const MeasuringRequest& wish) {
  std::vector<MeasuringPath> paths;
  for (const char* name : {"PPP", "NPP", "PNP", "PPN"}) paths.push_back(step_path(name, v, wish));
  return paths;
}

}  // namespace nonio::math
