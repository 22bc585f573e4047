// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "search/finding.h"

namespace nonio::model {

/// Where the verdict is `unknown`: explained again beside descriptions of place alone (a value for
/// each target, a reversal for each), which hold whatever of the rest repeats at a place and cannot
/// stand for what time does. What is certain there is certain; it comes into `out.certain`, and its
/// candidate says beside what. Then what is left beside all that is certain is described.
void describe(const Finding& finding, const std::vector<Term>& catalogue, Explanation& out);

}  // namespace nonio::model
