// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "cycle.h"

namespace nonio::hidden {

namespace {

/// To and fro between both ends with a stop in the middle, for so long.
Cycle exercise(const Scenario& s, const Cycle& runs, double duration) {
  Cycle c;
  c.length = runs.length;
  const double low = runs.targets.front(), high = runs.targets.back(), middle = (low + high) / 2.0;
  const double places[] = {low, middle, high, middle};
  double t = 0.0, last = low;
  for (std::size_t k = 0; t <= duration; ++k) {
    const double at = places[k % 4];
    t += k == 0 ? 0.0 : std::fabs(at - last) / s.feed + s.dwell;
    c.position.push_back(at), c.p.push_back(at - middle);
    c.d.push_back(k % 4 == 0 || k % 4 == 3 ? -1.0 : 1.0);
    c.t.push_back(std::round(10.0 * t) / 10.0);
    last = at;
  }
  c.duration = c.t.back();
  return c;
}

}  // namespace

Screw screw_of(const Scenario& s) {
  const Cycle runs = cycle_of(s);
  std::uint64_t stream = 10, of = 90;
  for (const auto* pieces : {&s.model, &s.hidden})
    for (const Piece& piece : *pieces) {
      if (piece.source == Source::screw_heating) of = stream;
      ++stream;
    }
  Random random(s.seed, of);
  const double tau = runs.duration * random.uniform(0.12, 0.4);
  return {tau, random};
}

Observations thermal_test(const Scenario& s, double times) {
  const Screw screw = screw_of(s);
  const Cycle c = exercise(s, cycle_of(s), 5.0 * times * screw.tau);
  Random random(s.seed, 91);
  const double size = random.sign() * random.uniform(20.0, 60.0) * s.noise;
  const double fixed = random.uniform(-0.6, 0.6) * c.length;
  const double drift = random.uniform(-10.0, 10.0) * s.noise;
  std::vector<double> growth = heated_screw(c, fixed, times * screw.tau, screw.random);
  double largest = 0.0;
  for (const double x : growth) largest = std::max(largest, std::fabs(x));
  double levels[3][2];
  for (auto& of_place : levels)
    for (double& one : of_place) one = random.uniform(-5.0, 5.0) * s.noise;
  Observations o;
  o.measurement = "X-thermal";
  o.axes = {{"X", false, c.position, {}}};
  o.lines = {{"X-thermal", {1.0, 0.0, 0.0}}};
  o.time = c.t;
  for (std::size_t i = 0; i < c.size(); ++i) {
    o.axes[0].approach.push_back(c.d[i] > 0.0 ? std::int8_t{1} : std::int8_t{-1});
    const double* level = levels[c.p[i] < 0.0 ? 0 : c.p[i] > 0.0 ? 2 : 1];
    o.deviation.push_back(size * growth[i] / largest + drift * c.t[i] / c.duration +
                          level[c.d[i] > 0.0 ? 0 : 1] + s.noise * random.normal());
    o.source_line.push_back(static_cast<std::uint32_t>(i + 2));
    o.run.push_back(1);
  }
  return o;
}

}  // namespace nonio::hidden
