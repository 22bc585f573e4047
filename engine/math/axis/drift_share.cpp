// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "drift_parts.h"
#include "nonio/math/distributions.h"
#include "nonio/math/drift.h"
#include "nonio/math/reversal.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

// Returns the contribution of drift to the largest s of a direction: s minus the square root of s^2
// minus the mean square that drift may contribute. Among equal values of s the larger contribution
// is used, so that rounding does not decide.
double in_scatter(const AxisTest& test, const Drift& drift, bool minus) {
  constexpr double equal = 1e-9;
  double largest = 0.0, share = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const auto part = minus ? test.minus(i) : test.plus(i);
    if (part.size() < 2) continue;
    const double s = standard_deviation(deviations(part));
    if (s < largest * (1.0 - equal)) continue;
    const double rate = std::hypot(drift.per_run_at(test.targets[i]), drift.u_at(test.targets[i]));
    const double left = s * s - squared(rate) * drift.course[minus ? 1 : 0][i].variance;
    const double own = s - std::sqrt(std::max(0.0, left));
    share = s > largest * (1.0 + equal) ? own : std::max(share, own);
    largest = std::max(largest, s);
  }
  return share;
}

void put_reversal(const AxisTest& test, const Drift& drift, double u_mean, DriftShare& share) {
  const double k_largest = factor_of_largest(test.targets.size(), 1e6);
  double by_offset = 0.0, by_slope = 0.0;
  bool positive = false, negative = false;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    if (test.plus(i).empty() || test.minus(i).empty()) continue;
    const double x = test.targets[i], rate = std::fabs(drift.per_run_at(x)), u = drift.u_at(x);
    const double lag = drift.lag(i), m = static_cast<double>(test.targets.size());
    const double of_B_i =
        squared(drift.scatter) * (1.0 / static_cast<double>(test.plus(i).size()) +
                                  1.0 / static_cast<double>(test.minus(i).size()));
    share.B =
        std::max(share.B, rate * std::fabs(lag) +
                              k_largest * std::sqrt(squared(lag * u) + of_B_i + squared(u_mean)));
    by_offset += lag / m, by_slope += lag * (x - drift.middle) / m;
    const double B = mean(deviations(test.plus(i))) - mean(deviations(test.minus(i)));
    positive = positive || B > 0.0, negative = negative || B < 0.0;
  }
  if (!test.bidirectional()) return;
  constexpr double k = 2.0;
  const double u = std::sqrt(squared(by_offset * drift.offset.u) +
                             squared(by_slope * drift.slope.u) + squared(u_mean));
  share.B_mean = std::max(share.B_mean, std::fabs(drift.in_B_mean) + k * u);
  share.U_mean = positive && negative ? share.B : share.B_mean;
}

/// Mean deviation at a target, from one direction (0, 1) or from both (2).
struct Mean {
  double value = 0.0, x = 0.0, time = 0.0, variance = 0.0;
  std::size_t direction = 0;
};

std::vector<Mean> means_of(const AxisTest& test, const Drift& drift, bool bidirectional) {
  std::vector<Mean> out;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    std::vector<Mean> both;
    for (const std::size_t d : {0U, 1U}) {
      const auto part = d == 0 ? test.plus(i) : test.minus(i);
      if (part.empty()) continue;
      both.push_back({mean(deviations(part)), test.targets[i] - drift.middle,
                      drift.course[d][i].mean,
                      squared(drift.scatter) / static_cast<double>(part.size()), d});
    }
    if (!bidirectional) out.insert(out.end(), both.begin(), both.end());
    if (bidirectional && both.size() == 2)
      out.push_back({(both[0].value + both[1].value) / 2.0, both[0].x,
                     (both[0].time + both[1].time) / 2.0,
                     (both[0].variance + both[1].variance) / 4.0, 2});
  }
  return out;
}

/// Error of the difference of two means by drift, and its variance with that of the means.
struct Difference {
  double drift = 0.0, variance = 0.0;
};

Difference difference_of(const Mean& high, const Mean& low, double middle, const Drift& drift,
                         double u_mean) {
  const double by_offset = high.time - low.time,
               by_slope = high.x * (high.time - middle) - low.x * (low.time - middle);
  // Every pass can have a slope of its own.
  const double own = drift.slope.known
                         ? std::max(0.0, drift.slope.variance - drift.slope.of_scatter) /
                               static_cast<double>(drift.runs)
                         : 0.0;
  const double lever = high.direction == 2               ? squared(high.x - low.x) / 2.0
                       : high.direction == low.direction ? squared(high.x - low.x)
                                                         : squared(high.x) + squared(low.x);
  return {by_offset * drift.offset.per_run + by_slope * drift.slope.per_run,
          squared(by_offset * drift.offset.u) + squared(by_slope * drift.slope.u) + high.variance +
              low.variance + own * lever +
              (high.direction != low.direction ? squared(u_mean) : 0.0)};
}

/// Contributions to the difference of the largest and the least mean.
struct OfRange {
  double measured = 0.0;  ///< only the pairs of means compete that could be the extremes
  double flat = 0.0;      ///< all pairs compete, as after compensation
};

OfRange share_of_range(const std::vector<Mean>& means, const Drift& drift, double u_mean) {
  if (means.size() < 2) return {};
  const auto less = [](const Mean& a, const Mean& b) { return a.value < b.value; };
  const Mean& high = *std::max_element(means.begin(), means.end(), less);
  const Mean& low = *std::min_element(means.begin(), means.end(), less);
  double middle = 0.0;
  for (const Mean& one : means) middle += one.time / static_cast<double>(means.size());
  const auto near = [&](const Mean& end) {
    return static_cast<std::size_t>(std::count_if(means.begin(), means.end(), [&](const Mean& one) {
      return std::fabs(one.value - end.value) <= 2.0 * std::sqrt(one.variance + end.variance);
    }));
  };
  const double dof = drift.scatter_dof > 0.0 ? drift.scatter_dof : 1e6;
  OfRange out;
  const Difference ends = difference_of(high, low, middle, drift, u_mean);
  out.measured = std::fabs(ends.drift) +
                 factor_of_largest(near(high) * near(low), dof) * std::sqrt(ends.variance);
  const double k = factor_of_largest(means.size() * (means.size() - 1), dof);
  for (const Mean& one : means) {
    const Difference d = difference_of(one, means.front(), middle, drift, u_mean);
    out.flat = std::max(out.flat, std::fabs(d.drift) + k * std::sqrt(d.variance));
  }
  return out;
}

// Misfit within which a course of the drift is possible, in chi^2: docs/dev/constants.md, M60.
constexpr double possible_within = 4.0;

DriftShare share_of_drift(const AxisTest& test) {
  DriftShare share;
  const std::vector<Drift> drifts = estimate_drifts(test);
  if (drifts.empty()) return share;
  share.scatter = drifts.front().scatter;
  const auto best =
      std::min_element(drifts.begin(), drifts.end(),
                       [](const Drift& a, const Drift& b) { return a.misfit() < b.misfit(); });
  const double freedom = best->offset.dof + best->slope.dof,
               of_one = std::max(1.0, freedom > 0.0 ? best->misfit() / freedom : 0.0);
  const Reversal reversal = assess_reversal(test);
  const double u_mean = std::isfinite(reversal.u_mean) ? reversal.u_mean : 0.0;
  for (const Drift& drift : drifts) {
    if (drift.misfit() > best->misfit() + possible_within * of_one) continue;
    share.s = std::max({share.s, in_scatter(test, drift, false), in_scatter(test, drift, true)});
    put_reversal(test, drift, u_mean, share);
    const OfRange E = share_of_range(means_of(test, drift, false), drift, u_mean),
                  M = share_of_range(means_of(test, drift, true), drift, u_mean);
    share.E = std::max(share.E, E.measured), share.M = std::max(share.M, M.measured);
    share.E_after = std::max(share.E_after, E.flat);
    share.M_after = std::max(share.M_after, M.flat);
  }
  return share;
}

}  // namespace

DriftShare drift_share(const AxisTest& test) { return kept<share_of_drift>(test); }

}  // namespace nonio::math
