// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/constants.h"

namespace nonio::math {
// The second pass removes the rounding error of the first.
double mean(std::span<const double> x) {
  if (x.empty()) return not_given;
  const double n = static_cast<double>(x.size());
  double sum = 0.0;
  for (const double v : x) sum += v;
  const double first = sum / n;
  double rest = 0.0;
  for (const double v : x) rest += v - first;
  return first + rest / n;
}

// s^2 = (sum d^2 - (sum d)^2/n)/(n - 1), d = x - mean; the second term is 0 except for rounding.
double standard_deviation(std::span<const double> x) {
  if (x.size() < 2) return not_given;
  const double n = static_cast<double>(x.size());
  const double m = mean(x);
  double squares = 0.0, rest = 0.0;
  for (const double v : x) {
    squares += (v - m) * (v - m);
    rest += v - m;
  }
  return std::sqrt(std::max(0.0, squares - rest * rest / n) / (n - 1.0));
}

double median(std::span<const double> x) {
  if (x.empty()) return not_given;
  std::vector<double> v(x.begin(), x.end());
  if (std::any_of(v.begin(), v.end(), [](double a) { return std::isnan(a); })) return not_given;
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  if (v.size() % 2 == 1) return *middle;
  const double lower = *std::max_element(v.begin(), middle);
  return lower + (*middle - lower) / 2.0;
}

double robust_deviation(std::span<const double> x) {
  constexpr double per_mad = 1.482602218505602;  // 1/Phi^-1(3/4), Phi of the normal distribution
  const double m = median(x);
  std::vector<double> away;
  away.reserve(x.size());
  for (const double v : x) away.push_back(std::fabs(v - m));
  return per_mad * median(away);
}

}  // namespace nonio::math
