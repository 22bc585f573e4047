// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/splitmix64.h"

#include <gtest/gtest.h>

#include "nonio/math/golden_section.h"
#include "nonio/sdk/fields.h"

namespace nonio {

/// The numbers that the author's program prints for this seed.
TEST(SplitMix64, TheNumbersAreThoseOfTheReference) {
  SplitMix64 numbers(1234567);
  EXPECT_EQ(numbers(), 6457827717110365317U);
  EXPECT_EQ(numbers(), 3203168211198807973U);
  EXPECT_EQ(numbers(), 9817491932198370423U);
  EXPECT_EQ(numbers(), 4593380528125082431U);
  EXPECT_EQ(SplitMix64::mixed(1234567), 6457827717110365317U);
}

TEST(SplitMix64, UniformNumbersLieInTheUnitInterval) {
  SplitMix64 numbers(7);
  double sum = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double x = numbers.uniform();
    EXPECT_GE(x, 0.0);
    EXPECT_LT(x, 1.0);
    sum += x;
  }
  EXPECT_NEAR(sum / 10000.0, 0.5, 5.0 / std::sqrt(12.0 * 10000.0));  // five standard deviations
}

TEST(GoldenSection, NarrowsToTheMinimumOfAParabola) {
  const auto f = [](double x) { return (x - 0.3) * (x - 0.3); };
  const math::Bracket found = math::golden_section(f, -1.0, 2.0, 30);
  EXPECT_NEAR(found.high - found.low, 3.0 * std::pow(0.6180339887498949, 30), 1e-12);
  EXPECT_LE(found.low, 0.3);
  EXPECT_GE(found.high, 0.3);
}

TEST(GoldenSection, StopsWhenItIsFineEnough) {
  int count = 0;
  const auto f = [&](double x) { return ++count, std::fabs(x); };
  const math::Bracket found = math::golden_section(f, -1.0, 1.0, 1000, 0.5);
  EXPECT_LE(found.high - found.low, 0.5);
  EXPECT_EQ(count, 5);  // two to begin with, and widths 1.24, 0.76, 0.47
}

TEST(EditDistance, CountsLettersThatDifferAreMissingOrTooMany) {
  using readers::edit_distance;
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("axis", "axsi"), 2U);
}

}  // namespace nonio
