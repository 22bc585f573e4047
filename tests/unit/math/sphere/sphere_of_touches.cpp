// SPDX-License-Identifier: Apache-2.0
// Lines "N RADIUS x y z ..." (m; radius 0: to be fitted) to "x y z r qx qy qz rss".
#include <array>
#include <iomanip>
#include <iostream>
#include <vector>

#include "nonio/math/sphere.h"

int main() {
  std::cout << std::setprecision(17);
  std::size_t n = 0;
  double radius = 0.0;
  while (std::cin >> n >> radius) {
    std::vector<std::array<double, 3>> touches(n);
    for (auto& t : touches) std::cin >> t[0] >> t[1] >> t[2];
    const auto fit = nonio::math::fit_sphere(
        touches, radius > 0.0 ? std::optional<double>(radius) : std::nullopt);
    if (!fit) {
      std::cout << "error " << fit.error().message << "\n";
      continue;
    }
    for (const double c : fit->centre) std::cout << c << " ";
    std::cout << fit->radius;
    for (const double q : fit->cofactor) std::cout << " " << q;
    std::cout << " " << fit->rss << "\n";
  }
  return 0;
}
