// SPDX-License-Identifier: Apache-2.0
#include "air.h"

#include <cmath>

namespace nonio::renishaw {

double half_wavelength(const Air& air) {
  constexpr double lambda = 0.632990577;  // um, vacuum
  constexpr double s2 = 1.0 / (lambda * lambda);
  const double t = air.temperature, p = air.pressure;
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - s2) + 15998.0 / (38.9 - s2));
  const double dry =
      p * standard / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * t) * p) / (1.0 + 0.0036610 * t);
  const double vapour = air.humidity / 100.0 * 611.2 * std::exp(17.62 * t / (243.12 + t));
  const double n = 1.0 + dry - vapour * (3.7345 - 0.0401 * s2) * 1e-10;
  return 1e-6 * lambda / (2.0 * n);
}

}  // namespace nonio::renishaw
