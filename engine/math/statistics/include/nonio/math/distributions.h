// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::math {

/// P(F > f) of Fisher's distribution; 1 if a degree of freedom is not positive: nothing was tested.
/// NaN where f or a degree of freedom is not a number.
double f_upper(double f, double dof1, double dof2);
/// P(|T| > |t|) of Student's distribution; 1 if the degree of freedom is not positive, NaN as
/// above.
double t_two_sided(double t, double dof);
/// P(chi-square > chi2); 1 if the degree of freedom is not positive.
double chi2_upper(double chi2, double dof);
/// z with P(N < z) = p
double normal_quantile(double p);
/// P(count or fewer) of so many trials that succeed with probability p.
double binomial_lower(int count, int trials, double p);
/// What a test divides by: 0 where there is nothing of either (readings without scatter that do not
/// differ), so that only what is really unknown is NaN.
double test_ratio(double found, double scatter);
/// p < level. What is not a number was not judged, so it is not passed over either: it counts as
/// significant, and evidence that is not a number stops its campaign.
inline bool significant(double p, double level) { return !(p >= level); }
/// k with P(|T| > k) = 4.55 %, so 2 for many degrees of freedom; NaN if they are not positive.
double coverage_factor(double dof);
/// What 95.45 % of a normal and one rectangular part need of 2 standard deviations, for the excess
/// (kurtosis less 3) that both have together: 1 at 0, 0.827 at -1.2, the rectangle alone.
double shape_factor(double excess);

}  // namespace nonio::math
