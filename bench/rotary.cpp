// SPDX-License-Identifier: Apache-2.0
// Circles per second on one core: `bench_rotary [COUNT] [POINTS]`; 8 points on a full turn with
// noise. Prints the rate, and a sum of the results so that nothing is left out.
#include "nonio/math/rotary.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

namespace {

using nonio::math::BallCentre;

int number(int argc, char** argv, int i, int otherwise) {
  if (i >= argc) return otherwise;
  const std::string_view text = argv[i];
  std::from_chars(text.data(), text.data() + text.size(), otherwise);
  return otherwise;
}

std::vector<std::vector<BallCentre>> circles(int count, int points) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0.0, 10e-6);
  std::vector<std::vector<BallCentre>> out;
  for (int i = 0; i < count; ++i) {
    auto& circle = out.emplace_back();
    for (int k = 0; k < points; ++k) {
      const double a = 2.0 * std::numbers::pi * k / points;
      circle.push_back({{0.102532 + 0.261 * std::cos(a) + noise(engine),
                         0.051230 + 0.261 * std::sin(a) + noise(engine), 0.128947 + noise(engine)},
                        a,
                        1.0});
    }
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = number(argc, argv, 1, 100000), points = number(argc, argv, 2, 8);
  const auto all = circles(1000, points);
  for (const bool angles : {false, true}) {
    double sum = 0.0;
    int refused = 0;
    const std::clock_t began = std::clock();
    for (int i = 0; i < count; ++i) {
      const auto fit =
          nonio::math::fit_rotary(all[static_cast<std::size_t>(i) % all.size()], angles);
      if (fit)
        sum += fit->centre[0] + std::sqrt(fit->cofactor[0][0]);
      else
        ++refused;
    }
    const double seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
    std::printf("%s: %.0f circles/s of CPU time (%d of %d points, %d refused, sum %.6f)\n",
                angles ? "with angles" : "geometric", count / seconds, count, points, refused, sum);
  }
}
