// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/distributions.h"

// Boost 1.74 copies its table of factorials at each look-up where the table is constexpr, which takes
// half of the time of a t distribution.
#define BOOST_NO_CXX14_CONSTEXPR
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/policies/policy.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace nonio::math {
namespace {
namespace bp = boost::math::policies;
// No function throws: a value that does not exist is NaN, and is tested below.
using Quiet = bp::policy<bp::domain_error<bp::ignore_error>, bp::pole_error<bp::ignore_error>,
                         bp::overflow_error<bp::ignore_error>,
                         bp::evaluation_error<bp::ignore_error>, bp::promote_double<false>>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

bool positive(double dof) { return std::isfinite(dof) && dof > 0.0; }
}  // namespace

double f_upper(double f, double dof1, double dof2) {
  if (std::isnan(f) || std::isnan(dof1) || std::isnan(dof2)) return not_a_number;
  if (!positive(dof1) || !positive(dof2) || f <= 0.0) return 1.0;
  if (std::isinf(f)) return 0.0;
  return cdf(complement(boost::math::fisher_f_distribution<double, Quiet>(dof1, dof2), f));
}

double t_two_sided(double t, double dof) {
  if (std::isnan(t) || std::isnan(dof)) return not_a_number;
  if (!positive(dof)) return 1.0;
  if (std::isinf(t)) return 0.0;
  return 2.0 *
         cdf(complement(boost::math::students_t_distribution<double, Quiet>(dof), std::fabs(t)));
}

double chi2_upper(double chi2, double dof) {
  if (!(dof > 0.0)) return 1.0;
  return cdf(complement(boost::math::chi_squared_distribution<double, Quiet>(dof), chi2));
}

double normal_quantile(double p) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p, Quiet());
}

double binomial_lower(int count, int trials, double p) {
  return cdf(boost::math::binomial_distribution<double, Quiet>(trials, p), count);
}

double test_ratio(double found, double scatter) {
  return found == 0.0 && scatter == 0.0 ? 0.0 : found / scatter;
}

double coverage_factor(double dof) {
  if (!(dof > 0.0)) return not_a_number;
  constexpr double outside = 0.04550026389635842;  // 1 - erf(2/sqrt 2)
  return quantile(
      complement(boost::math::students_t_distribution<double, Quiet>(dof), 0.5 * outside));
}

namespace {

constexpr double within = 0.95449973610364158;  // erf(2/sqrt 2)

/// P(|X| <= x) for X of variance 1: a rectangular part of variance share^2 and a normal part.
double share_within(double x, double share) {
  const double half = share * std::sqrt(3.0), sigma = std::sqrt(std::max(0.0, 1.0 - share * share));
  if (sigma < 1e-6) return std::min(1.0, x / half);
  const auto integral = [](double z) {  // integral of the normal distribution function
    return z * std::erfc(-z / std::numbers::sqrt2) / 2.0 +
           std::exp(-z * z / 2.0) / std::sqrt(2.0 * std::numbers::pi);
  };
  return sigma / half * (integral((x + half) / sigma) - integral((x - half) / sigma)) - 1.0;
}

}  // namespace

double shape_factor(double excess) {
  constexpr double of_rectangle = -1.2, hardly_any = -1e-4;
  if (!(excess < hardly_any)) return 1.0;
  // The excess of the sum is that of the rectangle times the fourth power of `share`.
  const double share = std::pow(std::min(1.0, excess / of_rectangle), 0.25);
  double low = 1.6, high = 2.1;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2.0;
    (share_within(middle, share) < within ? low : high) = middle;
  }
  return (low + high) / 4.0;
}

double factor_of_largest(std::size_t values, double dof) {
  const double tail = 0.0455 / static_cast<double>(values);
  double low = 2.0, high = 30.0;
  for (int halved = 0; halved < 40; ++halved) {
    const double k = (low + high) / 2.0;
    (t_two_sided(k, dof) / 2.0 > tail ? low : high) = k;
  }
  return low;
}

}  // namespace nonio::math
