// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/families.h"

#include <gtest/gtest.h>

namespace nonio::statistics::families_test {
namespace {

void near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
}

// By hand, as R's p.adjust gives them.
TEST(Families, AdjustedByHand) {
  const std::vector<double> p{0.01, 0.04, 0.03, 0.005};
  near(benjamini_hochberg(p), {0.02, 0.04, 0.04, 0.02});
  near(holm(p), {0.03, 0.06, 0.06, 0.02});
}

TEST(Families, NothingAndOne) {
  EXPECT_TRUE(benjamini_hochberg({}).empty());
  near(holm({0.3}), {0.3});
  near(benjamini_hochberg({1.0, 1.0}), {1.0, 1.0});
}

}  // namespace
}  // namespace nonio::statistics::families_test
