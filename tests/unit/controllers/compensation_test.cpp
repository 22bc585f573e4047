// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "workshop.h"

namespace compensation_test {

using namespace workshop;
using math::ErrorCurve;

namespace {

math::GridRule rule(std::size_t most = 200) {
  math::GridRule r;
  r.unit = 1e-7;
  r.most = most;
  r.axis = "X";
  return r;
}

}  // namespace

TEST(ErrorCurve, InterpolatesAndHoldsItsEnds) {
  const std::vector<double> x{0.0, 2.0, 3.0}, y{1.0, 5.0, 4.0};
  EXPECT_EQ(ErrorCurve::at(x, y, 1.0), 3.0);
  EXPECT_EQ(ErrorCurve::at(x, y, 2.0), 5.0);
  EXPECT_EQ(ErrorCurve::at(x, y, 2.5), 4.5);
  EXPECT_EQ(ErrorCurve::at(x, y, -7.0), 1.0);
  EXPECT_EQ(ErrorCurve::at(x, y, 7.0), 4.0);
  EXPECT_TRUE(std::isnan(ErrorCurve::at(x, y, std::nan(""))));
}

// A target reached from one side only would carry half of the reversal into the mean.
TEST(ErrorCurve, LeavesOutTargetsOfOneSide) {
  Bench b({"X",
           "X",
           false,
           {0.0, 0.1, 0.2},
           [](double) { return 2 * um; },
           [](double) { return 4 * um; }});
  auto& o = b.observations[0];
  o.axes[0].approach[1] = -1;  // target 0.1 from minus twice, never from plus
  const ErrorCurve c = curve_of(b);
  EXPECT_EQ(c.position, (std::vector<double>{0.0, 0.2}));
  EXPECT_EQ(c.left_out, 1U);
  EXPECT_NEAR(c.mean[0], 3 * um, 1e-18);
  EXPECT_NEAR(c.mean_reversal(), -2 * um, 1e-18);
}

TEST(Grid, TakesEvenTargetsAsTheyAre) {
  const auto g = math::choose_grid(even(-0.01, 0.05, 21), rule());
  ASSERT_TRUE(g);
  EXPECT_NEAR(g->first, -0.01, 1e-12);
  EXPECT_NEAR(g->step, 0.05, 1e-12);
  EXPECT_EQ(g->points, 21U);
}

// 14500 mm in 59 parts, printed to 1 um: the grid has as many points, none is off by over 10 um.
TEST(Grid, TakesTargetsThatWereRoundedForEven) {
  std::vector<double> x;
  for (int i = 0; i < 60; ++i) x.push_back(std::round(14500.0 / 59 * i * 1e3) * 1e-6);
  const auto g = math::choose_grid(x, rule());
  ASSERT_TRUE(g);
  EXPECT_EQ(g->points, 60U);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_NEAR(g->position(i), x[i], 10 * um);
}

TEST(Grid, FindsTheCommonStepOfUnevenTargets) {
  const auto g = math::choose_grid({0.0, 0.025, 0.1, 0.15}, rule());
  ASSERT_TRUE(g);
  EXPECT_NEAR(g->step, 0.025, 1e-12);
  EXPECT_EQ(g->points, 7U);
}

TEST(Grid, CoversUnevenTargets) {
  const std::vector<double> x{0.0012, 0.0531, 0.0987, 0.1522, 0.2003, 0.2511};
  const auto g = math::choose_grid(x, rule());
  ASSERT_TRUE(g);
  EXPECT_LE(g->first, x.front() + 1e-9);
  EXPECT_GE(g->last(), x.back() - 1e-9);
  EXPECT_LT(g->step, 0.03);
  EXPECT_GT(g->step, 0.01);
}

TEST(Grid, RefusesTooManyPointsWithASuggestionThatFits) {
  auto r = rule(200);
  r.step = 0.01;
  const auto targets = even(0.0, 0.25, 59);
  auto g = math::choose_grid(targets, r);
  ASSERT_FALSE(g);
  EXPECT_TRUE(contains(g.error().message,
                       "needs 1451 points, the control takes 200: set step_mm = 73 or more"))
      << g.error().message;
  r.step = 0.073;
  EXPECT_TRUE(math::choose_grid(targets, r));
  EXPECT_FALSE(math::choose_grid(even(0.0, 0.01, 300), rule(200)));
  EXPECT_TRUE(math::choose_grid(even(0.0, 0.01, 200), rule(200)));
}

TEST(Grid, HasTheReferenceOnIt) {
  auto r = rule();
  r.anchor = 0.0;
  const auto g = math::choose_grid(even(-0.012, 0.05, 8), r);
  ASSERT_TRUE(g);
  const double k = (0.0 - g->first) / g->step;
  EXPECT_NEAR(k, std::round(k), 1e-9);
  EXPECT_LE(g->first, -0.012 + 1e-9);
  EXPECT_GE(g->last(), -0.012 + 7 * 0.05 - 1e-9);
}

TEST(Grid, PowerOfTwoOfATenthOfAMicrometre) {
  auto r = rule(256);
  r.power_of_two = true;
  const auto g = math::choose_grid(even(0.0, 0.007, 72), r);
  ASSERT_TRUE(g);
  const double units = g->step / 1e-7;
  EXPECT_NEAR(std::log2(units), std::round(std::log2(units)), 1e-9);
  r.step = 0.007;
  const auto refused = math::choose_grid(even(0.0, 0.007, 72), r);
  ASSERT_FALSE(refused);
  EXPECT_TRUE(contains(refused.error().message, "step_mm = 13.1072")) << refused.error().message;
  r.step = 0.0065536;  // the manual's example for a wished 7 mm
  EXPECT_TRUE(math::choose_grid(even(0.0, 0.007, 72), r));
}

TEST(ClosedTurn, FoldsAndAveragesTheTwoEnds) {
  ErrorCurve c;
  c.position = even(-180 * deg, 45 * deg, 9);
  for (std::size_t i = 0; i < 9; ++i) c.mean.push_back(static_cast<double>(i));
  const auto t = math::closed_turn(c);
  ASSERT_TRUE(t);
  EXPECT_NEAR(t->position.front(), 0.0, 1e-12);
  EXPECT_NEAR(t->position.back(), 2 * std::numbers::pi, 1e-12);
  ASSERT_EQ(t->mean.size(), 9U);
  EXPECT_EQ(t->mean[0], 4.0);  // 0 deg
  EXPECT_EQ(t->mean[4], 4.0);  // 180 and -180 deg: (8 + 0) / 2
  EXPECT_EQ(t->mean[5], 1.0);  // -135 deg
  EXPECT_EQ(t->mean[8], t->mean[0]);
}

TEST(ClosedTurn, IsNotMadeOfAnArc) {
  ErrorCurve c;
  c.position = even(0.0, 30 * deg, 11);
  c.mean.assign(11, 0.0);
  EXPECT_FALSE(math::closed_turn(c));  // 300 deg of a turn in steps of 30
  c.position = even(0.0, 30 * deg, 12);
  c.mean.assign(12, 0.0);
  EXPECT_TRUE(math::closed_turn(c));
  c.position = even(0.0, 30 * deg, 14);
  c.mean.assign(14, 0.0);
  EXPECT_FALSE(math::closed_turn(c));  // more than a turn
}

// Rounding increments one by one would walk away; rounding the absolute curve cannot.
TEST(Quantised, SumIsNeverOffByMoreThanHalfAUnit) {
  const std::uint32_t seed = 20261121;
  print_seed(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 200; ++round) {
    const auto e = random_curve(random, 1.0, 40 * um);
    std::vector<double> absolute;
    for (const double x : even(0.0, 0.01, 101)) absolute.push_back(e(x));
    const double unit = 1 * um;
    const auto q = math::quantised(absolute, unit);
    std::int64_t sum = q[0];
    const auto steps = math::increments(q);
    ASSERT_EQ(steps.size(), 100U);
    for (std::size_t i = 1; i < absolute.size(); ++i) {
      sum += steps[i - 1];
      ASSERT_LE(std::fabs(static_cast<double>(sum) * unit - absolute[i]), unit / 2 * (1 + 1e-9))
          << "seed " << seed << ", round " << round;
    }
  }
}

TEST(MeanDeviations, AreTheLettersOfIso230) {
  const math::MeanDeviations d{{1 * um, 4 * um}, {3 * um, -2 * um}};
  EXPECT_NEAR(d.E(), 6 * um, 1e-18);  // -2..4
  EXPECT_NEAR(d.M(), 1 * um, 1e-18);  // means 2 and 1
  EXPECT_NEAR(d.B(), 6 * um, 1e-18);
  const math::MeanDeviations one{{1 * um, 4 * um}, {}};
  EXPECT_NEAR(one.E(), 3 * um, 1e-18);
  EXPECT_TRUE(std::isnan(one.B()));
  EXPECT_TRUE(std::isnan(one.M()));
  const math::MeanDeviations bad{{1 * um, std::nan("")}, {0.0, 0.0}};
  EXPECT_TRUE(std::isnan(bad.E()));
  EXPECT_TRUE(std::isnan(bad.B()));
}

}  // namespace compensation_test
