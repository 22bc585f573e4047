// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::math {

/// P(F > f) of Fisher's distribution; 1 if a degree of freedom is not positive.
double f_upper(double f, double dof1, double dof2);
/// P(|T| > |t|) of Student's distribution; 1 if the degree of freedom is not positive.
double t_two_sided(double t, double dof);
/// k with P(|T| > k) = 4.55 %, so 2 for many degrees of freedom; NaN if they are not positive.
double coverage_factor(double dof);

}  // namespace nonio::math
