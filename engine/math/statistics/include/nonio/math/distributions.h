// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace nonio::math {

/// P(F > f) of Fisher's distribution; 1 if a dof is not positive and finite, NaN for NaN.
double f_upper(double f, double dof1, double dof2);
/// P(|T| > |t|) of Student's distribution; 1 if dof is not positive and finite, NaN for NaN.
double t_two_sided(double t, double dof);
/// Returns P(X > chi2) of the chi-squared distribution; 1 if dof is not positive.
double chi2_upper(double chi2, double dof);
/// Returns the quantile z of the standard normal distribution: P(N < z) = p.
double normal_quantile(double p);
/// Returns the probability of at most `count` successes in `trials` trials with probability p each.
double binomial_lower(int count, int trials, double p);
/// Returns found/scatter; 0 if both are 0, so that NaN only results from unknown values.
double test_ratio(double found, double scatter);
/// Whether p < level. NaN counts as significant: a test that was not possible must not be ignored.
inline bool significant(double p, double level) { return !(p >= level); }
/// Returns k with P(|T| > k) = 4.55 %: 2 for many degrees of freedom, NaN if dof is not positive.
double coverage_factor(double dof);
/// Factor, relative to 2 standard deviations, of the 95.45 % interval of a sum of a normal and one
/// rectangular quantity: 1 for an excess (kurtosis minus 3) of 0, and 0.827 for -1.2, the excess of
/// the rectangular quantity alone.
double shape_factor(double excess);

/// Factor of the scatter that the largest of `values` exceeds at 4.55 %, at least 2; `dof`: of the
/// scatter.
double factor_of_largest(std::size_t values, double dof);

}  // namespace nonio::math
