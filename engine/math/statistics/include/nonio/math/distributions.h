// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::math {

/// Returns P(F > f) of Fisher's distribution; 1 if a degree of freedom is not positive or not
/// finite, because nothing was tested. NaN if f or a degree of freedom is NaN.
double f_upper(double f, double dof1, double dof2);
/// Returns P(|T| > |t|) of Student's distribution; 1 if the number of degrees of freedom is not
/// positive or not finite, NaN if an argument is NaN.
double t_two_sided(double t, double dof);
/// Returns P(X > chi2) of the chi-squared distribution; 1 if dof is not positive.
double chi2_upper(double chi2, double dof);
/// Returns the quantile z of the standard normal distribution: P(N < z) = p.
double normal_quantile(double p);
/// Returns the probability of at most `count` successes in `trials` trials with probability p each.
double binomial_lower(int count, int trials, double p);
/// Returns found/scatter for a test; 0 if both are 0 (readings without scatter that do not differ),
/// so that NaN only results from unknown values.
double test_ratio(double found, double scatter);
/// Returns whether p < level. NaN counts as significant, because a test that was not possible must
/// not be ignored: a finding whose evidence is NaN then stops the evaluation of its campaign.
inline bool significant(double p, double level) { return !(p >= level); }
/// Returns k with P(|T| > k) = 4.55 %, which is 2 for many degrees of freedom; NaN if dof is not
/// positive.
double coverage_factor(double dof);
/// Returns the factor, relative to 2 standard deviations, of the 95.45 % interval of a sum of a
/// normal and one rectangular quantity. excess: kurtosis of the sum minus 3. The factor is 1 for an
/// excess of 0, and 0.827 for -1.2, the excess of the rectangular quantity alone.
double shape_factor(double excess);

}  // namespace nonio::math
