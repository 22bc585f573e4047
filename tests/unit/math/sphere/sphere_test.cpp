// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/sphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "nonio/math/distributions.h"

namespace nonio::math {
namespace {

using Touches = std::vector<std::array<double, 3>>;

/// Touches along the axes of a sphere of radius 1 about the origin.
const Touches along_axes{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};

/// J'J of these: x and y 2 each; z and r with sums 1, -1 ... so that var z = 1 + 1/4 s^2 by hand:
/// r is the mean of four, z is one touch less r.
TEST(Sphere, CofactorsOfTouchesAlongTheAxes) {
  const auto fit = fit_sphere(along_axes);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->cofactor[0], 0.5, 1e-12);
  EXPECT_NEAR(fit->cofactor[1], 0.5, 1e-12);
  EXPECT_NEAR(fit->cofactor[2], 1.25, 1e-12);
  EXPECT_EQ(fit->dof, 1);
  EXPECT_NEAR(fit->radius, 1.0, 1e-12);
}

TEST(Sphere, AStatedRadiusIsKept) {
  const auto fit = fit_sphere(along_axes, 1.0);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->cofactor[2], 1.0, 1e-12);
  EXPECT_EQ(fit->dof, 2);
  EXPECT_EQ(fit->radius, 1.0);
}

TEST(Sphere, FarFromTheOriginTheSameDigitsRemain) {
  Touches far = along_axes;
  for (auto& t : far)
    for (double& x : t) x = 1000.0 + 0.01 * x;
  far[0][0] += 4e-6;
  const auto fit = fit_sphere(far);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->centre[0], 1000.0 + 2e-6, 1e-9);
  EXPECT_NEAR(fit->centre[2], 1000.0 - 1e-6, 1e-9);
}

TEST(Sphere, RefusesWhatDoesNotFixIt) {
  Touches plane{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0.6, 0.8, 0}};
  EXPECT_FALSE(fit_sphere(plane));
  EXPECT_FALSE(fit_sphere(Touches(along_axes.begin(), along_axes.end() - 1)));
  Touches bad = along_axes;
  bad[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_sphere(bad));
  Touches same(6, {1, 2, 3});
  EXPECT_FALSE(fit_sphere(same));
  Touches cap;  // within 3 degrees of the top
  for (int i = 0; i < 12; ++i)
    cap.push_back({0.05 * std::cos(i), 0.05 * std::sin(i * 1.3),
                   std::sqrt(1 - 0.0025 * (std::cos(i) * std::cos(i) +
                                           std::sin(i * 1.3) * std::sin(i * 1.3)))});
  EXPECT_FALSE(fit_sphere(cap));
}

/// Student's table, 95.45 %: 13.97 for 1, 2.28 for 10, 2 in the limit (GUM, table G.2).
TEST(Sphere, CoverageFactor) {
  EXPECT_NEAR(coverage_factor(1), 13.97, 0.005);
  EXPECT_NEAR(coverage_factor(10), 2.28, 0.005);
  EXPECT_NEAR(coverage_factor(1e9), 2.0, 1e-6);
  EXPECT_TRUE(std::isnan(coverage_factor(0)));
}

}  // namespace
}  // namespace nonio::math
