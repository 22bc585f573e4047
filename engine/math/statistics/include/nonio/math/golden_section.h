// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::math {

/// The interval that contains the minimum, and the function at the two points within.
struct Bracket {
  double low, high;
  double at_a, at_b;  ///< at high - g (high - low) and low + g (high - low), g = (sqrt(5) - 1)/2
};

/// Golden section (Kiefer, Proc. AMS 4 (1953) 502): narrows low..high about a minimum of f until it
/// is not wider than `fine`, at most in so many steps of one value of f each. A f with one minimum
/// keeps it inside; of several it keeps one.
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
