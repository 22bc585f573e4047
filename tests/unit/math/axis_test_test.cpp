// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_test.h"

#include <gtest/gtest.h>

#include "axis_builder.h"

namespace nonio::axis_test_test {
namespace {

using math::AxisTest;

Observations mixed() {
  Observations o;
  made::add(o, 0.2, -1, 8, 2);
  made::add(o, 0.1, 1, 1, 2);
  made::add(o, 0.1, 1, 2, 1);
  made::add(o, 0.2, -1, 7, 1);
  made::add(o, 0.1, -1, 3, 1);
  made::add(o, 0.2, 0, 9, 1);  // stood still: not part of the test
  return o;
}

TEST(AxisTest, IsByTargetDirectionAndRun) {
  const AxisTest t = AxisTest::arrange(mixed());
  ASSERT_EQ(t.targets, (std::vector<double>{0.1, 0.2}));
  ASSERT_EQ(t.plus(0).size(), 2U);
  EXPECT_EQ(t.plus(0)[0].deviation, 2.0);
  EXPECT_EQ(t.plus(0)[0].run, 1U);
  EXPECT_EQ(t.plus(0)[0].row, 2U);
  EXPECT_EQ(t.plus(0)[1].deviation, 1.0);
  ASSERT_EQ(t.minus(0).size(), 1U);
  EXPECT_TRUE(t.plus(1).empty());
  ASSERT_EQ(t.minus(1).size(), 2U);
  EXPECT_EQ(t.minus(1)[1].deviation, 8.0);
  EXPECT_EQ(t.readings().size(), 5U);
  EXPECT_TRUE(t.bidirectional());
  EXPECT_FALSE(t.complete());
  EXPECT_EQ(t.least_approaches(), 0U);
  EXPECT_EQ(t.most_approaches(), 2U);
  EXPECT_DOUBLE_EQ(t.length(), 0.1);
}

TEST(AxisTest, OneDirectionIsCompleteByItself) {
  Observations o;
  for (const double x : {0.0, 1.0}) made::add(o, x, -1, 0.0, 1);
  const AxisTest t = AxisTest::arrange(o);
  EXPECT_FALSE(t.has_plus());
  EXPECT_TRUE(t.has_minus());
  EXPECT_TRUE(t.complete());
  EXPECT_EQ(t.least_approaches(), 1U);
}

TEST(AxisTest, EmptyAndOddInput) {
  EXPECT_TRUE(AxisTest::arrange({}).targets.empty());
  EXPECT_EQ(AxisTest::arrange({}).least_approaches(), 0U);
  Observations no_approach = mixed();
  no_approach.axes[0].approach.clear();  // the axis stood still throughout
  EXPECT_TRUE(AxisTest::arrange(no_approach).targets.empty());
  Observations odd;
  made::add(odd, -0.0, 1, 1.0, 1);
  made::add(odd, 0.0, 1, 2.0, 2);
  made::add(odd, std::nan(""), 1, 2.0, 2);
  const AxisTest t = AxisTest::arrange(odd);
  ASSERT_EQ(t.targets.size(), 1U);
  EXPECT_EQ(t.plus(0).size(), 2U);
}

TEST(AxisTest, ManyDifferentTargets) {
  made::Random random(3);
  Observations o;
  std::map<double, int> count;
  for (int k = 0; k < 300000; ++k) {
    const double x = static_cast<double>(random() % 150000) * 1e-3;
    made::add(o, x, random() % 2 == 0 ? 1 : -1, 0.0, static_cast<std::uint32_t>(k));
    ++count[x];
  }
  const AxisTest t = AxisTest::arrange(o);
  ASSERT_EQ(t.targets.size(), count.size());
  std::size_t i = 0;
  for (const auto& [x, n] : count) {
    ASSERT_EQ(t.targets[i], x);
    ASSERT_EQ(t.plus(i).size() + t.minus(i).size(), static_cast<std::size_t>(n));
    ++i;
  }
}

TEST(AxisTest, OnlySomeTargets) {
  const AxisTest t = AxisTest::arrange(mixed());
  const std::vector<std::size_t> second = {1};
  const AxisTest only = t.only(second);
  ASSERT_EQ(only.targets, (std::vector<double>{0.2}));
  EXPECT_FALSE(only.has_plus());
  ASSERT_EQ(only.minus(0).size(), 2U);
  EXPECT_EQ(only.minus(0)[0].deviation, 7.0);
}

}  // namespace
}  // namespace nonio::axis_test_test
