// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/stretch.h"

#include <algorithm>

namespace nonio::statistics {
namespace {

/// Multiplies a sum of Legendre polynomials P_j(w) by w: w P_j = ((j + 1) P_j+1 + j P_j-1)/(2 j +
/// 1).
std::vector<double> times_w(const std::vector<double>& p) {
  std::vector<double> out(p.size() + 1, 0.0);
  for (std::size_t j = 0; j < p.size(); ++j) {
    const double of = p[j] / static_cast<double>(2 * j + 1);
    out[j + 1] += static_cast<double>(j + 1) * of;
    if (j > 0) out[j - 1] += static_cast<double>(j) * of;
  }
  return out;
}

/// Returns the coefficient of P_degree(w) in each of P_0(z) .. P_last(z) for z = middle + half w,
/// by the recurrence (k + 1) P_k+1(z) = (2 k + 1) z P_k(z) - k P_k-1(z).
std::vector<double> parts_along(std::size_t degree, double middle, double half, std::size_t last) {
  std::vector<double> out, before, now{1.0};
  for (std::size_t k = 0; k <= last; ++k) {
    out.push_back(degree < now.size() ? now[degree] : 0.0);
    std::vector<double> next = times_w(now);
    for (std::size_t j = 0; j < next.size(); ++j) {
      next[j] = half * next[j] + (j < now.size() ? middle * now[j] : 0.0);
      next[j] *= static_cast<double>(2 * k + 1);
      if (j < before.size()) next[j] -= static_cast<double>(k) * before[j];
      next[j] /= static_cast<double>(k + 1);
    }
    before = std::move(now), now = std::move(next);
  }
  return out;
}

}  // namespace

Stretch common_stretch(const Stretch& a, const Stretch& b) {
  const double from = std::max(a.from, b.from);
  return {from, std::max(from, std::min(a.to, b.to))};
}

CoefficientOver coefficient_over(const FittedCurve& c, const Stretch& other, std::size_t degree) {
  const std::size_t n = c.coefficients.size();
  const double half = other.length() / c.over.length(),
               middle = (other.from + other.to - c.over.from - c.over.to) / c.over.length();
  const std::vector<double> a = parts_along(degree, middle, half, n - 1);
  CoefficientOver out;
  for (std::size_t i = 0; i < n; ++i) {
    out.value += a[i] * c.coefficients[i];
    for (std::size_t j = 0; j < n; ++j) {
      out.variance += a[i] * a[j] * c.covariance[i * n + j];
      out.share += a[i] * a[j] * c.share[i * n + j];
    }
  }
  return out;
}

}  // namespace nonio::statistics
