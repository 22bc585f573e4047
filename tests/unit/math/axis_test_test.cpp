// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>

#include "axis_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/reversal.h"

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
  made::add(o, 0.2, 0, 9, 1);  // no approach: not part of the test
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
  no_approach.axes[0].approach.clear();  // the axis never moved
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

/// What is said of a test, every digit of it.
std::string said_of(const AxisTest& test) {
  std::vector<Finding> findings;
  math::drift_findings(test, findings);
  math::suspect_findings(test, findings);
  const math::Reversal reversal = math::assess_reversal(test);
  std::ostringstream out;
  out << std::hexfloat << reversal.mean << " " << reversal.u_mean << " " << reversal.p_varies;
  for (const Finding& finding : findings) {
    out << " " << finding.id;
    for (const Number& number : finding.evidence) out << " " << number.value;
  }
  return out.str();
}

// Fits are kept for who asks again: what was asked before must not show.
TEST(AxisTest, WhatWasAskedBeforeChangesNothing) {
  constexpr unsigned seed = 7;
  made::Random random(seed);
  std::vector<AxisTest> tests;
  for (int k = 0; k < 40; ++k) {
    Observations o;
    const int targets = 3 + k % 5, runs = 2 + k % 4;
    for (int run = 1; run <= runs; ++run)
      for (int i = 0; i < targets; ++i)
        for (const int direction : {1, -1})
          made::add(o, 0.1 * i, direction,
                    1e-6 * (static_cast<double>(random() % 1000) / 100.0 + run * (k % 3)),
                    static_cast<std::uint32_t>(run));
    tests.push_back(AxisTest::arrange(o));
    // The same but for one bit, one target, or the direction of one reading.
    o.deviation[1] = std::nextafter(o.deviation[1], 1.0);
    tests.push_back(AxisTest::arrange(o));
    o.axes[0].position.back() += 1e-6;
    tests.push_back(AxisTest::arrange(o));
    o.axes[0].approach[0] = -o.axes[0].approach[0];
    tests.push_back(AxisTest::arrange(o));
  }
  std::vector<std::string> forwards;
  for (const AxisTest& test : tests) forwards.push_back(said_of(test));
  EXPECT_GT(std::set<std::string>(forwards.begin(), forwards.end()).size(), 60U);
  for (std::size_t k = tests.size(); k-- > 0;) {
    EXPECT_EQ(said_of(tests[k]), forwards[k]) << "test " << k << ", seed " << seed;
    const std::size_t other = random() % tests.size();
    EXPECT_EQ(said_of(tests[other]), forwards[other]) << "test " << other << ", seed " << seed;
    EXPECT_EQ(said_of(tests[k]), forwards[k]) << "again, test " << k << ", seed " << seed;
  }
}

}  // namespace
}  // namespace nonio::axis_test_test
