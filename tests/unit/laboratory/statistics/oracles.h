// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

/// Other ways to the same answers, written for tests only: nothing of Nonio uses them, for a
/// machine has few campaigns, and these want many points.
namespace nonio::statistics::oracle {

/// z_t = L x_t + (1 - L) z_(t-1).
inline std::vector<double> ewma(const std::vector<double>& x, double start, double L) {
  std::vector<double> out;
  double z = start;
  for (const double v : x) out.push_back(z = L * v + (1.0 - L) * z);
  return out;
}

/// Upper and lower sums; k in the unit of x.
struct Cusum {
  std::vector<double> upper, lower;
};
inline Cusum cusum(const std::vector<double>& x, double target, double k) {
  Cusum out;
  double high = 0.0, low = 0.0;
  for (const double v : x) {
    out.upper.push_back(high = std::max(0.0, high + v - target - k));
    out.lower.push_back(low = std::max(0.0, low + target - v - k));
  }
  return out;
}

/// Largest |U| over the places, how many points are before it, and its approximate p.
struct Pettitt {
  double K = 0.0;
  std::size_t before = 0;
  double p = 1.0;
};
inline Pettitt pettitt(const std::vector<double>& x) {
  Pettitt out;
  const std::size_t n = x.size();
  for (std::size_t t = 1; t < n; ++t) {
    double U = 0.0;
    for (std::size_t i = 0; i < t; ++i)
      for (std::size_t j = t; j < n; ++j) U += x[i] > x[j] ? 1.0 : x[i] < x[j] ? -1.0 : 0.0;
    if (std::fabs(U) > out.K) out.K = std::fabs(U), out.before = t;
  }
  const double N = static_cast<double>(n);
  out.p = 2.0 * std::exp(-6.0 * out.K * out.K / (N * N * N + N * N));
  return out;
}

/// Least sum of squares over `variance` with a penalty for each segment: points before each change.
inline std::vector<std::size_t> best_segments(const std::vector<double>& x, double variance,
                                              double penalty) {
  const std::size_t n = x.size();
  std::vector<double> sum(n + 1, 0.0), squares(n + 1, 0.0), F(n + 1, -penalty);
  std::vector<std::size_t> from(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    sum[i + 1] = sum[i] + x[i], squares[i + 1] = squares[i] + x[i] * x[i];
  for (std::size_t t = 1; t <= n; ++t) {
    F[t] = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < t; ++s) {
      const double of = sum[t] - sum[s], count = static_cast<double>(t - s),
                   cost = F[s] + (squares[t] - squares[s] - of * of / count) / variance + penalty;
      if (cost < F[t]) F[t] = cost, from[t] = s;
    }
  }
  std::vector<std::size_t> out;
  for (std::size_t t = from[n]; t > 0; t = from[t]) out.insert(out.begin(), t);
  return out;
}

}  // namespace nonio::statistics::oracle
