// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>

#include "laboratory/statistics/series.h"

namespace nonio::statistics {

/// Eight campaigns of one reversal, um and years: invented, used by all reference values here.
inline Series reference_series() {
  const double t[] = {0, .5, 1.1, 1.6, 2, 2.6, 3.1, 3.5},
               y[] = {-4.1, -4.3, -4.6, -4.5, -5, -5.3, -5.2, -5.6},
               u[] = {.25, .25, .30, .25, .20, .20, .25, .20};
  Series s;
  for (int i = 0; i < 8; ++i) s.points.push_back({t[i], y[i], u[i]});
  return s;
}

/// n campaigns half a year apart, with u and a value that `truth` gives.
template <class Truth>
Series made_series(std::size_t n, double u, std::mt19937_64& random, const Truth& truth) {
  std::normal_distribution<double> noise;
  Series s;
  s.seed = random();
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.5 * static_cast<double>(i);
    s.points.push_back({t, truth(i, t) + u * noise(random), u});
  }
  return s;
}

}  // namespace nonio::statistics
