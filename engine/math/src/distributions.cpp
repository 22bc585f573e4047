// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/distributions.h"

#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/policies/policy.hpp>
#include <cmath>
#include <limits>

namespace nonio::math {
namespace {
namespace bp = boost::math::policies;
// Nothing throws: a value that cannot be had is NaN, and asked for below.
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

double test_ratio(double found, double scatter) {
  return found == 0.0 && scatter == 0.0 ? 0.0 : found / scatter;
}

double coverage_factor(double dof) {
  if (!(dof > 0.0)) return not_a_number;
  constexpr double outside = 0.04550026389635842;  // 1 - erf(2/sqrt 2)
  return quantile(
      complement(boost::math::students_t_distribution<double, Quiet>(dof), 0.5 * outside));
}

}  // namespace nonio::math
