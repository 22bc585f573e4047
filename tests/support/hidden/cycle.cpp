// SPDX-License-Identifier: Apache-2.0
#include "cycle.h"

#include <algorithm>
#include <cmath>

namespace nonio::hidden {
namespace {

/// Even, or each moved by up to 30 % of the distance, as ISO 230-2 wants against periodic errors.
std::vector<double> targets_of(const Scenario& s, Random random) {
  const double m = static_cast<double>(s.targets);
  const double step = s.rotary ? s.length / m : s.length / (m - 1.0);
  const double resolution = s.rotary ? pi / 180.0 * 1e-3 : 1e-6;
  std::vector<double> targets;
  for (std::size_t i = 0; i < s.targets; ++i) {
    const double offset = s.even ? 0.0 : random.uniform(-0.3, 0.3) * step;
    const double at = static_cast<double>(i) * step + offset;
    targets.push_back(std::round(at / resolution) * resolution);
  }
  return targets;
}

/// A room with a cycling air conditioner and a little trend; the machine follows it late.
std::vector<double> material_of(const std::vector<double>& t, double duration, Random random) {
  const double period = duration * random.uniform(0.35, 0.9);
  const double phase = random.uniform(0.0, 2.0 * pi);
  const double swing = random.uniform(0.6, 2.0), trend = random.uniform(-0.5, 0.5);
  const double lag = duration * random.uniform(0.05, 0.2);
  const auto room = [&](double at) {
    return swing * std::sin(2.0 * pi * at / period + phase) + trend * at / duration;
  };
  std::vector<double> material;
  const double step = duration / 5000.0;
  double now = -5.0 * lag, body = room(now);
  for (const double at : t) {
    for (; now < at; now += step) body += (room(now) - body) * step / lag;
    material.push_back(body);
  }
  double mean = 0.0;
  for (const double m : material) mean += m / static_cast<double>(material.size());
  for (double& m : material) m = std::round((20.0 + m - mean) * 100.0) / 100.0;
  return material;
}

}  // namespace

Cycle cycle_of(const Scenario& s) {
  Cycle c;
  c.targets = targets_of(s, Random(s.seed, 1));
  Random random(s.seed, 2);
  const double low = c.targets.front(), high = c.targets.back();
  c.length = high - low;
  const double overshoot = 0.02 * c.length;
  double t = 0.0, last = low;
  for (std::uint32_t run = 1; run <= s.runs; ++run) {
    for (const double d : {1.0, -1.0}) {
      if (s.one_way && d < 0.0) break;
      for (std::size_t k = 0; k < c.targets.size(); ++k) {
        const double at = c.targets[d > 0.0 ? k : c.targets.size() - 1 - k];
        const double turn = k == 0 ? 2.0 * overshoot : 0.0;
        if (!c.position.empty())
          t += (std::fabs(at - last) + turn) / s.feed + s.dwell * random.uniform(0.95, 1.05);
        c.position.push_back(at);
        c.p.push_back(at - (low + high) / 2.0);
        c.d.push_back(d);
        c.t.push_back(std::round(t * 10.0) / 10.0);
        c.since_turn.push_back(overshoot + (d > 0.0 ? at - low : high - at));
        c.run.push_back(run);
        last = at;
      }
    }
    t += s.pause * random.uniform(0.7, 1.3);
  }
  c.duration = c.t.back();
  c.material = material_of(c.t, c.duration, Random(s.seed, 3));
  return c;
}

double rms_about_mean(const std::vector<double>& values) {
  double mean = 0.0, sum = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace nonio::hidden
