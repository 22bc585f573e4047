// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/iso230_2.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

Iso230Point evaluate_target(const AxisStatistics::Target& t, double k) {
  Iso230Point p{};
  p.target = t.target;
  p.n_plus = t.plus.n;
  p.n_minus = t.minus.n;
  p.mean_plus = t.plus.mean;
  p.mean_minus = t.minus.mean;
  p.mean = t.mean;
  p.B = t.B;
  p.s_plus = t.plus.s;
  p.s_minus = t.minus.s;
  p.R_plus = 2.0 * k * p.s_plus;
  p.R_minus = 2.0 * k * p.s_minus;
  const double both = k * p.s_plus + k * p.s_minus + std::fabs(p.B);
  p.R = std::isnan(both) ? both : std::max({both, p.R_plus, p.R_minus});
  return p;
}

}  // namespace

Iso230Result evaluate_iso230_2(const AxisTest& test, double k) {
  return evaluate_iso230_2(axis_statistics(test), k);
}

Iso230Result evaluate_iso230_2(const AxisStatistics& axis, double k) {
  Iso230Result result{};
  result.k = k;
  Extent A, A_plus, A_minus, E, E_plus, E_minus, M, R, R_plus, R_minus, B;
  std::vector<double> B_i;
  for (const AxisStatistics::Target& t : axis.targets) {
    const Iso230Point p = evaluate_target(t, k);
    if (p.n_plus > 0) {
      E_plus.put(p.mean_plus);
      A_plus.put(p.mean_plus + k * p.s_plus);
      A_plus.put(p.mean_plus - k * p.s_plus);
      R_plus.put(p.R_plus);
    }
    if (p.n_minus > 0) {
      E_minus.put(p.mean_minus);
      A_minus.put(p.mean_minus + k * p.s_minus);
      A_minus.put(p.mean_minus - k * p.s_minus);
      R_minus.put(p.R_minus);
    }
    for (const double xm : {p.mean_plus, p.mean_minus}) E.put(xm);
    for (const double side : {-k, k}) {
      A.put(p.mean_plus + side * p.s_plus);
      A.put(p.mean_minus + side * p.s_minus);
    }
    M.put(p.mean);
    R.put(p.R);
    B.put(std::fabs(p.B));
    B_i.push_back(p.B);
    result.points.push_back(p);
  }
  result.A = A.range(), result.A_plus = A_plus.range(), result.A_minus = A_minus.range();
  result.E = E.range(), result.E_plus = E_plus.range(), result.E_minus = E_minus.range();
  result.M = M.range();
  result.R = R.largest(), result.R_plus = R_plus.largest(), result.R_minus = R_minus.largest();
  result.B = B.largest();
  result.B_mean = mean(B_i);
  return result;
}

}  // namespace nonio::math
