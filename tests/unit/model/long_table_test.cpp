// SPDX-License-Identifier: Apache-2.0
// Long tables, which are tested by means of their readings.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "nonio/model/comparison.h"

namespace nonio::model::long_table_test {

namespace {

constexpr double noise = 0.5e-6;

/// 200 runs at 21 targets, there and back: 8,400 readings of noise.
Part long_part() {
  std::mt19937_64 random(7);
  std::normal_distribution<double> e(0.0, noise);
  Part part;
  part.measurements = {"X"};
  part.axes = {Axis{.name = "X"}};
  Observations& o = part.table;
  o.axes = {{"X", false, {}, {}}};
  o.lines = {{"X", {1, 0, 0}}};
  for (std::uint32_t run = 1; run <= 200; ++run)
    for (int k = 0; k < 42; ++k) {
      o.axes[0].position.push_back(0.05 * (k < 21 ? k : 41 - k));
      o.axes[0].approach.push_back(k < 21 ? 1 : -1);
      o.run.push_back(run);
      o.deviation.push_back(e(random));
    }
  return part;
}

}  // namespace

TEST(LongTable, NoiseHasNoPlace) {
  const auto c = compare(long_part(), {});
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_GT(c->means, 0u);
  EXPECT_FALSE(c->places.empty());
  EXPECT_FALSE(c->fails());
}

/// A reversal of a fifth of the noise cannot be seen in a reading; in 8,400 it can.
TEST(LongTable, PlaceOfAReversal) {
  Part part = long_part();
  for (std::size_t i = 0; i < part.table.size(); ++i)
    part.table.deviation[i] += 0.1 * noise * part.table.axes[0].approach[i];
  const auto c = compare(part, {});
  ASSERT_TRUE(c) << c.error().message;
  ASSERT_TRUE(c->fails());
  EXPECT_EQ(to_text(c->places.front().where), "direction");
}

TEST(LongTable, MisreadValueIsSuspectedAndMakesNoPlace) {
  Part part = long_part();
  part.table.deviation[5000] += 5000.0 * noise;
  const auto c = compare(part, {});
  ASSERT_TRUE(c) << c.error().message;
  ASSERT_EQ(c->suspects.size(), 1u);
  EXPECT_EQ(c->suspects[0].row, 5000u);
  EXPECT_FALSE(c->fails());
}

}  // namespace nonio::model::long_table_test
