// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::math {

/// An interval that contains the minimum, and the values of the function at its two inner points.
struct Bracket {
  double low, high;
  /// values at high - g (high - low) and low + g (high - low), g = (sqrt(5) - 1)/2
  double at_a, at_b;
};

/// Golden section search (Kiefer, Proc. AMS 4 (1953) 502): narrows low..high about a minimum of f
/// to a width of at most `fine`, in at most `steps` evaluations after the first two.
template <class Function>
Bracket golden_section(Function&& f, double low, double high, int steps, double fine = 0.0) {
  constexpr double golden = 0.6180339887498949;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = f(a), at_b = f(b);
  for (int step = 0; step < steps && high - low > fine; ++step) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      at_a = f(a = high - golden * (high - low));
    } else {
      low = a, a = b, at_a = at_b;
      at_b = f(b = low + golden * (high - low));
    }
  }
  return {low, high, at_a, at_b};
}

}  // namespace nonio::math
