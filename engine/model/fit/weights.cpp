// SPDX-License-Identifier: Apache-2.0
#include "fit/weights.h"

#include <algorithm>
#include <cmath>

namespace nonio::model {

void set_weights(std::span<Term> candidates) {
  // docs/dev/constants.md, M55.
  constexpr double equal_part = 0.5, largest = 8.0;
  double sum = 0.0, counted = 0.0;
  for (const Term& t : candidates)
    if (t.frequency) sum += *t.frequency, ++counted;
  for (Term& t : candidates)
    t.weight =
        t.frequency && sum > 0.0
            ? std::min(equal_part + (1.0 - equal_part) * *t.frequency * counted / sum, largest)
            : 1.0;
}

double evidence_of_weight(double weight) { return 2.0 * std::log(weight); }

}  // namespace nonio::model
