// SPDX-License-Identifier: Apache-2.0
// A level that walks: reference values of the Nile and of eight campaigns.
#include "laboratory/statistics/walk.h"

#include <gtest/gtest.h>

#include <cmath>

#include "made.h"
#include "nile.h"

namespace nonio::statistics::walk_test {
namespace {

Series river(double variance) {
  Series s;
  for (std::size_t i = 0; i < std::size(nile); ++i)
    s.points.push_back({static_cast<double>(i), nile[i], std::sqrt(variance)});
  return s;
}

TEST(Walk, TheNile) {
  EXPECT_NEAR(walk_with(river(15098.5), 1469.18).log_likelihood, -632.5456, 6e-5);
  const Walk last = walk_with(river(15099), 1469.1);
  EXPECT_NEAR(last.state, 798.3703, 6e-5);
  EXPECT_NEAR(last.variance, 4032.158, 6e-4);
  EXPECT_NEAR(last.variance + 1469.1 + 15099, 20600.26, 6e-3);
  EXPECT_NEAR(last.variance + 10 * 1469.1 + 15099, 33822.16, 6e-3);
  EXPECT_NEAR(likeliest_walk(river(15098.5)).q, 1469.18, 1.0);
}

TEST(Walk, EightCampaigns) {
  const Walk best = likeliest_walk(reference_series());
  EXPECT_NEAR(best.q, 0.15985, 6e-5);
  EXPECT_NEAR(best.log_likelihood, -2.81737, 6e-6);
  const Walk walk = walk_with(reference_series(), 0.1);
  EXPECT_NEAR(walk.log_likelihood, -3.02787, 6e-6);
  EXPECT_NEAR(walk.state, -5.4523, 6e-5);
  EXPECT_NEAR(std::sqrt(walk.variance), 0.1614, 6e-5);
  EXPECT_NEAR(std::sqrt(walk.variance + 0.1), 0.35501, 6e-6);
}

TEST(Walk, NoneWhereALevelSaysAsMuch) {
  Series s;
  for (int i = 0; i < 8; ++i) s.points.push_back({static_cast<double>(i), i % 2 * 0.1, 1.0});
  EXPECT_EQ(likeliest_walk(s).q, 0.0);
}

}  // namespace
}  // namespace nonio::statistics::walk_test
