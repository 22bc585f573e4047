// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "nonio/math/axis_test.h"

/// Invented tests of an axis: a deviation for each target, direction and run, and scatter on top.
namespace nonio::made {

struct Noise {
  double reading = 0.0;       ///< of each reading alone, m or rad
  double run = 0.0;           ///< common to both passes of a run
  double pass = 0.0;          ///< common to a pass
  double minus_factor = 1.0;  ///< scatter of readings in direction - against +
};

struct Plan {
  std::vector<double> targets;
  std::uint32_t runs = 5;
  bool plus = true, minus = true;
  bool rotary = false;
};

using Truth = std::function<double(double target, int direction, std::uint32_t run)>;
using Random = std::mt19937_64;

inline double normal(Random& random) { return std::normal_distribution<double>()(random); }
inline double uniform(Random& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

/// m targets over a length, shifted from an even spacing by up to 30 % of the interval.
inline std::vector<double> spread_targets(Random& random, std::size_t m, double length) {
  std::vector<double> targets;
  const double p = length / static_cast<double>(m - 1);
  for (std::size_t i = 0; i < m; ++i)
    targets.push_back(static_cast<double>(i) * p + uniform(random, -0.3, 0.3) * p);
  return targets;
}

inline void add(Observations& o, double target, int direction, double deviation,
                std::uint32_t run) {
  if (o.axes.empty()) o.axes.push_back({"X", false, {}, {}});
  o.axes[0].position.push_back(target);
  o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
  o.deviation.push_back(deviation);
  o.run.push_back(run);
}

inline Observations observe(const Plan& plan, const Truth& truth, const Noise& noise,
                            Random& random) {
  Observations o;
  o.angular = plan.rotary;
  o.axes.push_back({"X", plan.rotary, {}, {}});
  for (std::uint32_t run = 1; run <= plan.runs; ++run) {
    const double of_run = noise.run * normal(random);
    for (const int direction : {1, -1}) {
      if (!(direction > 0 ? plan.plus : plan.minus)) continue;
      const double of_pass = noise.pass * normal(random);
      const double s = noise.reading * (direction > 0 ? 1.0 : noise.minus_factor);
      for (const double target : plan.targets)
        add(o, target, direction,
            truth(target, direction, run) + of_run + of_pass + s * normal(random), run);
    }
  }
  return o;
}

inline math::AxisTest arranged(const Plan& plan, const Truth& truth, const Noise& noise,
                               Random& random) {
  return math::AxisTest::arrange(observe(plan, truth, noise, random));
}

}  // namespace nonio::made
