// SPDX-License-Identifier: Apache-2.0
// Decisions: docs/dev/constants.md, A18 (few turns); docs/dev/constants.md, A19 (waves).
#include "nonio/math/spindle.h"

#include <algorithm>
#include <cmath>

#include "common/constants.h"

namespace nonio::math {

namespace {

constexpr std::size_t fewest_in_turn = 16, fewest_turns = 2;
// Largest gap between readings, rad: docs/dev/constants.md, A17.
constexpr double widest_gap = full_turn / 8.0;
constexpr double as_read = 1e-4;  // rad: tolerance for angles at even steps

/// Returns 0 unless the readings are at even steps that divide the turn.
std::size_t even_steps(const SpindleTrack& k) {
  const double step = (k.angle.back() - k.angle.front()) / static_cast<double>(k.angle.size() - 1);
  const double n = std::round(full_turn / step);
  if (!(std::fabs(full_turn / n - step) * static_cast<double>(k.angle.size()) < as_read)) return 0;
  for (std::size_t i = 0; i < k.angle.size(); ++i)
    if (std::fabs(k.angle[i] - k.angle.front() - step * static_cast<double>(i)) > as_read) return 0;
  return static_cast<std::size_t>(n);
}

/// Cubic through the four readings about x (Lagrange); at the ends through the first or last four.
double cubic(const SpindleTrack& k, std::size_t behind, double x) {
  const std::size_t first = std::min(behind < 2 ? 0 : behind - 2, k.angle.size() - 4);
  double sum = 0.0;
  for (std::size_t i = first; i < first + 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + 4; ++j)
      if (j != i) weight *= (x - k.angle[j]) / (k.angle[i] - k.angle[j]);
    sum += weight * k.r[i];
  }
  return sum;
}

bool with_gap(const SpindleTrack& k) {
  for (std::size_t i = 1; i < k.angle.size(); ++i)
    if (!(k.angle[i] - k.angle[i - 1] <= widest_gap)) return true;
  return false;
}

}  // namespace

double Turns::angle(std::size_t i) const {
  return full_turn * static_cast<double>(i) / static_cast<double>(n);
}

std::optional<Turns> turns_of(const SpindleTrack& k) {
  constexpr std::size_t most_in_turn = 4096;
  if (k.angle.size() < fewest_turns * fewest_in_turn || with_gap(k)) return {};
  const double span = k.angle.back() - k.angle.front();
  if (!(span > 0.0 && span < 1e9)) return {};
  Turns out;
  if (const std::size_t n = even_steps(k);
      n >= fewest_in_turn &&
      std::fabs(std::remainder(k.angle.front(), full_turn / static_cast<double>(n))) < as_read) {
    // Turns begin at the first reading; the curve begins at angle 0 of the spindle.
    const double turn = std::fmod(std::fmod(k.angle.front(), full_turn) + full_turn, full_turn);
    const auto shift =
        static_cast<std::size_t>(std::lround(turn / full_turn * static_cast<double>(n)));
    out.n = n, out.N = k.r.size() / n;
    out.r.resize(out.n * out.N);
    for (std::size_t i = 0; i < out.r.size(); ++i) out.r[i / n * n + (i + shift) % n] = k.r[i];
    if (out.N < fewest_turns) return {};
    return out;
  }
  const double first = std::ceil(k.angle.front() / full_turn - 1e-9) * full_turn;
  const double turns = std::floor((k.angle.back() - first) / full_turn + 1e-9);
  if (!(turns >= static_cast<double>(fewest_turns))) return {};
  out.N = static_cast<std::size_t>(turns);
  out.n = std::min(
      most_in_turn,
      static_cast<std::size_t>(static_cast<double>(k.angle.size() - 1) / span * full_turn + 1e-6));
  if (out.n < fewest_in_turn) return {};
  out.resampled = true;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < out.n * out.N; ++i) {
    const double x = first + full_turn * static_cast<double>(i) / static_cast<double>(out.n);
    while (behind + 1 < k.angle.size() && k.angle[behind] < x) ++behind;
    out.r.push_back(cubic(k, behind, x));
  }
  return out;
}

std::optional<Turns> rotating(const Turns& X, const Turns& Y, int sense) {
  if (X.n != Y.n || X.N != Y.N) return {};
  Turns out = X;
  for (std::size_t i = 0; i < out.r.size(); ++i) {
    const double t = X.angle(i % X.n);
    out.r[i] = X.r[i] * std::cos(t) + sense * Y.r[i] * std::sin(t);
  }
  out.resampled = X.resampled || Y.resampled;
  return out;
}

int sense_of(const ErrorMotion& X, const ErrorMotion& Y) {
  constexpr double clearly = 3.0;  // ratio that decides the sense: docs/dev/constants.md, A27
  const double f = std::hypot(X.a + Y.b, X.b - Y.a) / 2.0;
  const double g = std::hypot(X.a - Y.b, X.b + Y.a) / 2.0;
  const double noise = 4.0 * std::hypot(X.u_ab, Y.u_ab);
  if (!(std::max(f, g) > std::max({X.synchronous, Y.synchronous, noise}))) return 0;
  return f >= clearly * g ? 1 : g >= clearly * f ? -1 : 0;
}

double range_of(std::span<const double> values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

double ErrorMotion::fundamental() const { return 2.0 * std::hypot(a, b); }
double ErrorMotion::eccentricity() const { return std::hypot(a, b); }

namespace {

struct OfTurn {
  double m = 0.0, a = 0.0, b = 0.0;
};

std::vector<OfTurn> turn_by_turn(const Turns& k) {
  std::vector<OfTurn> out(k.N);
  const auto n = static_cast<double>(k.n);
  for (std::size_t i = 0; i < k.r.size(); ++i) {
    const double t = k.angle(i % k.n);
    OfTurn& o = out[i / k.n];
    o.m += k.r[i] / n, o.a += 2.0 / n * k.r[i] * std::cos(t), o.b += 2.0 / n * k.r[i] * std::sin(t);
  }
  return out;
}

/// N (1 - rho)/(1 + rho), at least 1.5; rho: correlation of successive turns' asynchronous motion.
double turns_that_count(const Turns& k, const std::vector<double>& left) {
  double with = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    squares += left[i] * left[i];
    if (i >= k.n) with += left[i] * left[i - k.n];
  }
  const auto N = static_cast<double>(k.N);
  if (!(squares > 0.0)) return N;
  // Subtracting the mean of N turns reduces the correlation by about 1/N.
  const double rho = std::clamp(with / squares * N / (N - 1.0) + 1.0 / N, 0.0, 0.95);
  return std::max(1.5, N * (1.0 - rho) / (1.0 + rho));
}

}  // namespace

ErrorMotion error_motion(const Turns& k) {
  ErrorMotion out;
  const auto turns = turn_by_turn(k);
  const auto N = static_cast<double>(k.N);
  for (const OfTurn& o : turns) out.mean += o.m / N, out.a += o.a / N, out.b += o.b / N;
  out.motion.assign(k.n, 0.0);
  std::vector<double> left(k.r.size()), low(k.n, INFINITY), high(k.n, -INFINITY);
  double least = INFINITY, most = -INFINITY;
  out.total_with_once = range_of(k.r);
  for (std::size_t i = 0; i < k.r.size(); ++i) {
    const double t = k.angle(i % k.n);
    left[i] = k.r[i] - out.mean - out.a * std::cos(t) - out.b * std::sin(t);
    least = std::min(least, left[i]), most = std::max(most, left[i]);
    out.motion[i % k.n] += left[i] / N;
  }
  out.total = most - least;
  double squares = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    left[i] -= out.motion[i % k.n];
    squares += left[i] * left[i];
    low[i % k.n] = std::min(low[i % k.n], left[i]),
            high[i % k.n] = std::max(high[i % k.n], left[i]);
  }
  for (std::size_t i = 0; i < k.n; ++i) {
    out.asynchronous = std::max(out.asynchronous, high[i] - low[i]);
    if (out.motion[i] < out.motion[out.low]) out.low = i;
    if (out.motion[i] > out.motion[out.high]) out.high = i;
    const double t = k.angle(i);
    out.with_once.push_back(out.motion[i] + out.a * std::cos(t) + out.b * std::sin(t));
  }
  out.synchronous = range_of(out.motion);
  out.synchronous_with_once = range_of(out.with_once);
  out.s = std::sqrt(squares / (static_cast<double>(k.n) * (N - 1.0)));
  const double count = turns_that_count(k, left);
  out.u_mean = out.s / std::sqrt(count);
  out.dof = std::max(1.0, count - 1.0);
  double scatter = 0.0;
  for (const OfTurn& o : turns)
    scatter += (std::pow(o.a - out.a, 2) + std::pow(o.b - out.b, 2)) / 2.0;
  out.u_ab = std::sqrt(scatter / (N - 1.0) / count);
  return out;
}

Separated donaldson(std::span<const double> T1, std::span<const double> T2) {
  Separated out;
  for (std::size_t i = 0; i < std::min(T1.size(), T2.size()); ++i) {
    out.spindle.push_back((T1[i] - T2[i]) / 2.0);
    out.ball.push_back((T1[i] + T2[i]) / 2.0);
  }
  return out;
}

Separated multi_step(std::span<const std::vector<double>> T) {
  Separated out;
  if (T.empty()) return out;
  const std::size_t n = T.front().size(), K = T.size();
  out.spindle.assign(n, 0.0), out.ball.assign(n, 0.0);
  for (const auto& one : T)
    for (std::size_t i = 0; i < n; ++i) out.spindle[i] += one[i] / static_cast<double>(K);
  // T_k(t) - S(t) = P(-t - 360 k/K): the curves are averaged, turned back to the first set-up.
  for (std::size_t k = 0; k < K; ++k)
    for (std::size_t i = 0; i < n; ++i) {
      const double from =
          static_cast<double>(i) - static_cast<double>(k * n) / static_cast<double>(K);
      const double whole = std::floor(from), part = from - whole;
      const auto index = [&](double x) {
        return static_cast<std::size_t>(
            std::fmod(x + 2.0 * static_cast<double>(n), static_cast<double>(n)));
      };
      const std::size_t one = index(whole), next = index(whole + 1.0);
      const double left =
          (1.0 - part) * (T[k][one] - out.spindle[one]) + part * (T[k][next] - out.spindle[next]);
      out.ball[i] += left / static_cast<double>(K);
    }
  return out;
}

}  // namespace nonio::math
