// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/decision.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {

double guard_band(double U, std::string_view rule, double k) {
  if (rule == "ilac-g8-simple") return 0.0;
  if (rule == "ilac-g8-guarded" || rule == "iso14253-1:2013") return U;
  // One-sided 95 % of a normal distribution, in units of u. Of Student's distribution it is at most
  // the same part of U as with k = 2.
  return 1.65 / std::min(k, 2.0) * U;
}

Decision decide(double value, double U, double tolerance, std::string_view rule, double k) {
  if (!std::isfinite(value) || !std::isfinite(U)) return Decision::cannot_be_decided;
  const double guard = guard_band(U, rule, k);
  if (rule == "ilac-g8-simple" || rule == "ilac-g8-guarded")
    return value > tolerance - guard ? Decision::does_not_conform : Decision::conforms;
  if (value <= tolerance - guard) return Decision::conforms;
  if (value > tolerance + guard) return Decision::does_not_conform;
  return Decision::cannot_be_decided;
}

double least_U(const Laboratory& laboratory, Quantity quantity, double length,
               const Ranges& measured) {
  if (laboratory.accreditation.empty()) return 0.0;
  const Cmc& cmc = laboratory.cmc;
  switch (quantity) {
    case Quantity::length:
    case Quantity::deviation:
      return cmc.fixed.value_or(0.0) + cmc.per_length.value_or(0.0) * length;
    case Quantity::angle:
    case Quantity::angular_deviation:
    case Quantity::small_angle:
    case Quantity::number:  // components of a direction have the uncertainty of an angle
      return cmc.angle.value_or(0.0);
    case Quantity::deviation_per_length:
      return measured.length > 0.0
                 ? cmc.fixed.value_or(0.0) / measured.length + cmc.per_length.value_or(0.0)
                 : 0.0;
    case Quantity::deviation_per_angle:
      return measured.angle > 0.0 ? cmc.angle.value_or(0.0) / measured.angle : 0.0;
    default:
      return 0.0;
  }
}

}  // namespace nonio::math
