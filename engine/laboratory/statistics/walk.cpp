// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/walk.h"

#include <cmath>
#include <numbers>

namespace nonio::statistics {
namespace {

double variance_at(const Series& s, std::size_t i) {
  const double u = s.excess * s.points[i].u;
  return u * u;
}

}  // namespace

Walk walk_with(const Series& s, double q) {
  Walk out{q, 0.0, s.points.front().value, variance_at(s, 0)};
  for (std::size_t i = 1; i < s.points.size(); ++i) {
    out.variance += q * (s.points[i].time - s.points[i - 1].time);
    const double F = out.variance + variance_at(s, i), v = s.points[i].value - out.state,
                 K = out.variance / F;
    out.log_likelihood -= 0.5 * (std::log(2.0 * std::numbers::pi * F) + v * v / F);
    out.state += K * v;
    out.variance *= 1.0 - K;
  }
  return out;
}

Walk likeliest_walk(const Series& s) {
  Walk best = walk_with(s, 0.0);
  double low = 1e-6 * variance_at(s, 0), high = 1e6 * variance_at(s, 0);
  for (int round = 0; round < 5; ++round) {
    const double ratio = std::pow(high / low, 1.0 / 40.0);
    for (int k = 0; k <= 40; ++k)
      if (const Walk walk = walk_with(s, low * std::pow(ratio, k));
          walk.log_likelihood > best.log_likelihood)
        best = walk;
    if (best.q == 0.0) break;
    low = best.q / ratio, high = best.q * ratio;
  }
  return best;
}

}  // namespace nonio::statistics
