// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/decision.h"

#include <cmath>

namespace nonio::math {

Decision decide(double value, double U, double tolerance, std::string_view rule) {
  const bool simple = rule == "ilac-g8-simple", guarded = rule == "ilac-g8-guarded";
  // One-sided 95 % of a normal distribution, in units of U with k = 2.
  constexpr double one_sided = 1.65 / 2.0;
  const double guard = rule == "iso14253-1:2013" ? U : one_sided * U;
  if (!std::isfinite(value) || !std::isfinite(U)) return Decision::cannot_be_decided;
  if (simple || guarded)
    return value <= (guarded ? tolerance - U : tolerance) ? Decision::conforms
                                                          : Decision::does_not_conform;
  if (value <= tolerance - guard) return Decision::conforms;
  if (value > tolerance + guard) return Decision::does_not_conform;
  return Decision::cannot_be_decided;
}

}  // namespace nonio::math
