// SPDX-License-Identifier: Apache-2.0
//
// S of VDI/DGQ 3441 is the mean of both directions, not the pooled sqrt((S+^2 + S-^2)/2).
#include "nonio/math/vdi3441.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/constants.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

// Mean range of n normal values in units of their standard deviation: the integral of 1 - Phi^n -
// (1 - Phi)^n (L. H. C. Tippett 1925, Biometrika 17, p. 364).
constexpr std::array<double, 11> d_n = {
    not_given,      not_given,      1.128379167096, 1.692568750643, 2.058750746008, 2.325928947281,
    2.534412721223, 2.704356751214, 2.847200612091, 2.970026324418, 3.077505461670};

double deviation_of_side(const AxisStatistics::Side& side, StandardDeviation how) {
  if (how == StandardDeviation::direct) return side.s;
  if (side.n < 2 || side.n >= d_n.size()) return not_given;
  return (side.high - side.low) / d_n[side.n];
}

double largest(const std::vector<double>& x) {
  double out = x.empty() ? not_given : x.front();
  for (const double v : x) out = std::isnan(v) || std::isnan(out) ? not_given : std::max(out, v);
  return out;
}

// Returns max(x + h) - min(x - h); NaN if a value is NaN, or without values.
double extent(const std::vector<double>& x, const std::vector<double>& h) {
  std::vector<double> high, low;
  for (std::size_t j = 0; j < x.size(); ++j) {
    high.push_back(x[j] + h[j]);
    low.push_back(h[j] - x[j]);
  }
  return largest(high) + largest(low);
}

struct Sided {
  std::vector<double> mean, band, flat;
  void put(double x, double S) {
    mean.push_back(x);
    band.push_back(3.0 * S);
    flat.push_back(0.0);
  }
};

}  // namespace

VdiResult evaluate_vdi3441(const AxisTest& test, StandardDeviation how) {
  return evaluate_vdi3441(axis_statistics(test), how);
}

VdiResult evaluate_vdi3441(const AxisStatistics& axis, StandardDeviation how) {
  VdiResult result{};
  Sided one[2];
  std::vector<double> xs, flat, half, U, Ps, PsU;
  for (const AxisStatistics::Target& t : axis.targets) {
    const double xm_plus = t.plus.mean, xm_minus = t.minus.mean;
    VdiPoint p{};
    p.target = t.target;
    p.mean = t.mean;
    p.S_plus = deviation_of_side(t.plus, how);
    p.S_minus = deviation_of_side(t.minus, how);
    p.S = (p.S_plus + p.S_minus) / 2.0;
    p.U = std::fabs(xm_plus - xm_minus);
    p.Ps = 6.0 * p.S;
    if (t.plus.n > 0) one[0].put(xm_plus, p.S_plus);
    if (t.minus.n > 0) one[1].put(xm_minus, p.S_minus);
    xs.push_back(p.mean);
    flat.push_back(0.0);
    half.push_back((p.U + p.Ps) / 2.0);
    U.push_back(p.U);
    Ps.push_back(p.Ps);
    PsU.push_back(p.U + p.Ps);
    result.points.push_back(p);
  }
  result.P = extent(xs, half);
  result.Pa = extent(xs, flat);
  result.Ps_max = largest(Ps), result.Ps_mean = mean(Ps);
  result.U_max = largest(U), result.U_mean = mean(U);
  result.PsU_max = largest(PsU);
  result.P_plus = extent(one[0].mean, one[0].band);
  result.P_minus = extent(one[1].mean, one[1].band);
  result.Pa_plus = extent(one[0].mean, one[0].flat);
  result.Pa_minus = extent(one[1].mean, one[1].flat);
  result.Ps_max_plus = 2.0 * largest(one[0].band);
  result.Ps_max_minus = 2.0 * largest(one[1].band);
  return result;
}

}  // namespace nonio::math
