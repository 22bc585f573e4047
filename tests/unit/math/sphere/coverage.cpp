// SPDX-License-Identifier: Apache-2.0
// How often U (k of Student for 95.45 %) holds the true coordinate: sphere_coverage TRIALS SEED
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "nonio/math/distributions.h"
#include "nonio/math/sphere.h"

namespace {

using Random = std::mt19937_64;

std::vector<std::array<double, 3>> touches(const std::array<double, 3>& centre, double r,
                                           double sigma, int n, Random& random) {
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<std::array<double, 3>> out;
  for (int i = 0; i < n; ++i) {  // one on top, the others on two rings
    const double height = i == 0 ? 0.5 * std::numbers::pi : i % 2 == 0 ? 0.6 : 0.0;
    const double around = 2.4 * i, distance = r + noise(random);
    out.push_back({centre[0] + distance * std::cos(height) * std::cos(around),
                   centre[1] + distance * std::cos(height) * std::sin(around),
                   centre[2] + distance * std::sin(height)});
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::stoi(argv[1]) : 400;
  const auto seed = argc > 2 ? std::stoull(argv[2]) : 1ULL;
  Random random(seed);
  int held = 0, asked = 0;
  for (int trial = 0; trial < trials; ++trial) {
    // Eight centres of one file, five to nine touches each: their scatter is pooled, as the reader
    // does.
    double rss = 0.0;
    int dof = 0;
    std::vector<std::pair<std::array<double, 3>, nonio::math::SphereFit>> fits;
    for (int k = 0; k < 8; ++k) {
      const std::array<double, 3> centre{0.1 * k, -0.3, 0.05 * k};
      const auto fit = nonio::math::fit_sphere(touches(centre, 0.0125, 1e-6, 5 + k % 5, random));
      if (!fit) {
        std::cerr << fit.error().message << "\n";
        return 2;
      }
      rss += fit->rss;
      dof += fit->dof;
      fits.emplace_back(centre, *fit);
    }
    const double expanded = nonio::math::coverage_factor(dof) * std::sqrt(rss / dof);
    for (const auto& [centre, fit] : fits)
      for (std::size_t i = 0; i < 3; ++i, ++asked)
        if (std::fabs(fit.centre[i] - centre[i]) <= expanded * std::sqrt(fit.cofactor[i])) ++held;
  }
  const double share = static_cast<double>(held) / asked;
  // 24 coordinates of a trial share one s; the share of a trial scatters by 0.06 at most.
  const double slack = 4.0 * 0.06 / std::sqrt(static_cast<double>(trials));
  std::cout << "U holds " << held << " of " << asked << " coordinates, " << 100.0 * share
            << " %; expected 95.45 % within " << 100.0 * slack << ", seed " << seed << "\n";
  return std::fabs(share - 0.9545) <= slack ? 0 : 1;
}
