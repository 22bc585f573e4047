// SPDX-License-Identifier: Apache-2.0
//
// What must hold of every test of an axis, on random ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "axis_builder.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/positioning.h"
#include "nonio/math/reversal.h"
#include "nonio/math/vdi3441.h"

namespace nonio::axis_properties_test {
namespace {

using math::AxisTest;
using math::Iso230Result;

struct Sample {
  Observations observations;
  double k = 2.0;
};

Sample sample(made::Random& random) {
  made::Plan plan;
  plan.targets = made::spread_targets(random, 3 + random() % 20, made::uniform(random, 0.1, 15.0));
  plan.runs = 2 + static_cast<std::uint32_t>(random() % 6);
  const double B = made::uniform(random, -1e-5, 1e-5);
  const double slope = made::uniform(random, -2e-5, 2e-5);
  made::Noise noise{made::uniform(random, 1e-8, 3e-6), made::uniform(random, 0.0, 1e-6),
                    made::uniform(random, 0.0, 1e-6), made::uniform(random, 0.5, 3.0)};
  const auto truth = [&](double x, int d, std::uint32_t) {
    return slope * x + 1e-6 * std::sin(40.0 * x) + (d > 0 ? B : 0.0);
  };
  return {made::observe(plan, truth, noise, random), random() % 4 == 0 ? 3.0 : 2.0};
}

std::vector<double> list(const Iso230Result& r) {
  return {r.A, r.A_plus, r.A_minus, r.E,       r.E_plus, r.E_minus,
          r.M, r.R,      r.R_plus,  r.R_minus, r.B,      r.B_mean};
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_TRUE(std::fabs(a[i] - b[i]) <= tolerance) << i << ": " << a[i] << " " << b[i];
}

class AxisProperties : public testing::TestWithParam<std::uint64_t> {
 protected:
  made::Random random{GetParam()};
  Sample s = sample(random);
  Iso230Result before = math::evaluate_iso230_2(AxisTest::arrange(s.observations), s.k);
};

TEST_P(AxisProperties, OrderOfValues) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const Iso230Result& r = before;
  const double rounding = 1e-15;
  EXPECT_GE(r.R, std::max(r.R_plus, r.R_minus));
  EXPECT_GE(r.R + rounding, r.B);
  EXPECT_LE(r.E, r.A + rounding);
  EXPECT_LE(std::max(r.E_plus, r.E_minus), r.E + rounding);
  EXPECT_LE(std::max(r.A_plus, r.A_minus), r.A + rounding);
  EXPECT_LE(r.M, r.E + rounding);
  EXPECT_LE(std::fabs(r.B_mean), r.B + rounding);
  EXPECT_LE(r.E_plus, r.A_plus + rounding);
  EXPECT_GE(r.A_plus + rounding, r.R_plus);  // the band at one target is part of the whole
  for (const auto& p : r.points) EXPECT_GE(p.R, std::fabs(p.B));
}

TEST_P(AxisProperties, ACommonShiftChangesNothing) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations shifted = s.observations;
  for (double& d : shifted.deviation) d += 0.25;
  expect_near(list(before), list(math::evaluate_iso230_2(AxisTest::arrange(shifted), s.k)), 1e-15);
}

TEST_P(AxisProperties, ScaleScalesEverything) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations scaled = s.observations;
  for (double& d : scaled.deviation) d *= 4.0;  // exact
  auto wanted = list(before);
  for (double& v : wanted) v *= 4.0;
  expect_near(wanted, list(math::evaluate_iso230_2(AxisTest::arrange(scaled), s.k)), 1e-18);
}

TEST_P(AxisProperties, OrderOfRowsAndRunsDoesNotMatter) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const Observations& o = s.observations;
  std::vector<std::size_t> order(o.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  Observations mixed;
  for (const std::size_t i : order)
    made::add(mixed, o.axes[0].position[i], o.axes[0].approach[i], o.deviation[i], o.run[i]);
  const AxisTest a = AxisTest::arrange(o), b = AxisTest::arrange(mixed);
  ASSERT_EQ(a.targets, b.targets);
  expect_near(list(before), list(math::evaluate_iso230_2(b, s.k)), 0.0);  // the same sums
  ASSERT_EQ(a.readings().size(), b.readings().size());
  for (std::size_t i = 0; i < a.readings().size(); ++i) {
    EXPECT_EQ(a.readings()[i].run, b.readings()[i].run);
    EXPECT_EQ(a.readings()[i].deviation, b.readings()[i].deviation);
  }
  std::vector<std::uint32_t> renamed = mixed.run;
  const std::uint32_t last = *std::max_element(renamed.begin(), renamed.end());
  for (auto& run : mixed.run) run = last + 1 - run;
  expect_near(list(before), list(math::evaluate_iso230_2(AxisTest::arrange(mixed), s.k)), 1e-17);
}

TEST_P(AxisProperties, SwappedDirectionsSwapTheValues) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations swapped = s.observations;
  for (auto& approach : swapped.axes[0].approach) approach = static_cast<std::int8_t>(-approach);
  const Iso230Result r = math::evaluate_iso230_2(AxisTest::arrange(swapped), s.k);
  expect_near({r.A, r.A_minus, r.A_plus, r.E, r.E_minus, r.E_plus, r.M, r.R, r.R_minus, r.R_plus,
               r.B, -r.B_mean},
              list(before), 1e-17);
}

TEST_P(AxisProperties, MirroredAxis) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations mirrored = s.observations;
  for (auto& x : mirrored.axes[0].position) x = -x;
  for (auto& d : mirrored.deviation) d = -d;
  for (auto& approach : mirrored.axes[0].approach) approach = static_cast<std::int8_t>(-approach);
  const Iso230Result r = math::evaluate_iso230_2(AxisTest::arrange(mirrored), s.k);
  expect_near({r.A, r.A_minus, r.A_plus, r.E, r.E_minus, r.E_plus, r.M, r.R, r.R_minus, r.R_plus,
               r.B, r.B_mean},  // lost motion stays lost motion
              list(before), 1e-17);
}

TEST_P(AxisProperties, VdiAndIsoAgreeWhereTheyMeanTheSame) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const AxisTest test = AxisTest::arrange(s.observations);
  const auto vdi = math::evaluate_vdi3441(test, math::StandardDeviation::direct);
  const auto iso = math::evaluate_iso230_2(test, 3.0);
  EXPECT_NEAR(vdi.Pa, iso.M, 1e-18);
  EXPECT_NEAR(vdi.U_max, iso.B, 1e-18);
  EXPECT_GE(vdi.U_mean + 1e-18, std::fabs(iso.B_mean));
  EXPECT_NEAR(vdi.P_plus, iso.A_plus, 1e-18);
  EXPECT_GE(vdi.P, vdi.Pa);
  EXPECT_LE(vdi.Ps_mean, vdi.Ps_max);
  EXPECT_LE(vdi.Ps_max, std::max(iso.R_plus, iso.R_minus) + 1e-18);
}

// Every value of every rule, by "rule:symbol".
using ByName = std::map<std::string, double>;
ByName by_every_rule(const Observations& o, math::Offset offset = math::Offset::mean_of_all) {
  ByName out;
  const math::AxisStatistics axis = math::axis_statistics(AxisTest::arrange(o));
  for (const auto& rule : math::positioning_rules())
    for (const auto& v : math::evaluate_rule(rule, axis, offset))
      out[std::string(rule.name) + ":" + std::string(v.name)] = v.value;
  return out;
}

constexpr double nothing = 1e-15;  // m

TEST_P(AxisProperties, RulesAreTiedTogether) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const ByName v = by_every_rule(s.observations);
  for (const char* iso : {"iso-1988:", "iso-2006:", "gb-10931:", "b5.54-2005:"}) {
    const std::string rule = iso;
    EXPECT_GE(v.at(rule + "R") + nothing, v.at(rule + "B"));
    EXPECT_GE(v.at(rule + "A") + nothing, v.at(rule + "R"));
  }
  for (const char* one : {"R+", "R-"}) {
    const std::string name = one;
    EXPECT_NEAR(v.at("iso-1988:" + name), 1.5 * v.at("iso-2014:" + name), nothing);
  }
  EXPECT_GE(v.at("iso-1988:A"), v.at("iso-2014:A"));
  EXPECT_LE(v.at("iso-1988:A"), 1.5 * v.at("iso-2014:A") + nothing);
  EXPECT_EQ(v.at("upr:UPR"), std::min(v.at("iso-2014:R+"), v.at("iso-2014:R-")));
  EXPECT_NEAR(v.at("nmtba:+-repeatability"), v.at("iso-1988:R") / 2.0, nothing);
  EXPECT_NEAR(v.at("nmtba:+-repeatability+"), v.at("iso-1988:R+") / 2.0, nothing);
  EXPECT_EQ(v.at("vdi-3441:Pa"), v.at("iso-2014:M"));
  EXPECT_GE(v.at("vdi-3441:PsU_max") + nothing, v.at("vdi-3441:U_max"));
  EXPECT_LE(v.at("b5.54-1992:R'"), v.at("b5.54-1992:A'"));
  EXPECT_LE(v.at("b5.54-1992:R'+"), v.at("b5.54-1992:R'"));
  EXPECT_LE(v.at("iso-2014:E"), v.at("b5.54-1992:A'") + nothing);  // means lie among readings
  EXPECT_LE(v.at("jis-6330:accuracy"), v.at("b5.54-1992:A'+"));
  EXPECT_LE(2.0 * v.at("jis-6330:+-repeatability"),
            std::max(v.at("b5.54-1992:R'+"), v.at("b5.54-1992:R'-")) + nothing);
  EXPECT_LE(v.at("jis-6330:lost_motion"), v.at("iso-2014:B"));
}

// Half of A with 3 s is the least +- accuracy that any constant can give.
TEST_P(AxisProperties, NoOffsetIsBelowHalfOfA) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  for (const auto offset :
       {math::Offset::mean_of_all, math::Offset::first_target, math::Offset::mid_range}) {
    const ByName v = by_every_rule(s.observations, offset);
    EXPECT_GE(v.at("nmtba-no-offset:+-accuracy") + nothing, v.at("iso-1988:A") / 2.0);
    EXPECT_GE(v.at("nmtba:+-accuracy") + nothing, v.at("iso-1988:A") / 2.0);
  }
}

TEST_P(AxisProperties, AShiftChangesNmtbaWithOffsetAndNothingElse) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations shifted = s.observations;
  for (double& d : shifted.deviation) d += 0.25;
  const ByName first = by_every_rule(s.observations), after = by_every_rule(shifted);
  for (const auto& [name, value] : first)
    if (name.starts_with("nmtba:+-accuracy")) {
      EXPECT_GT(after.at(name), 0.2) << name;
    } else {
      EXPECT_NEAR(after.at(name), value, 1e-15) << name;
    }
}

TEST_P(AxisProperties, EveryRuleScalesAndSwaps) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  Observations scaled = s.observations, swapped = s.observations;
  for (double& d : scaled.deviation) d *= 4.0;  // exact
  for (auto& approach : swapped.axes[0].approach) approach = static_cast<std::int8_t>(-approach);
  const ByName first = by_every_rule(s.observations), larger = by_every_rule(scaled),
               other = by_every_rule(swapped);
  for (const auto& [name, value] : first) {
    EXPECT_NEAR(larger.at(name), 4.0 * value, 1e-17) << name;
    if (name.starts_with("jis-63") && name.ends_with(":accuracy")) continue;  // of the first pass
    std::string there = name;
    if (there.back() == '+' || there.back() == '-') there.back() = name.back() == '+' ? '-' : '+';
    EXPECT_NEAR(other.at(there), name.ends_with("B_mean") ? -value : value, 1e-17) << name;
  }
}

TEST_P(AxisProperties, VdiEqualsIso1988WhereBothDirectionsScatterAlike) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const AxisTest test = AxisTest::arrange(s.observations);
  Observations alike;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const auto& r : test.plus(i)) {
      made::add(alike, test.targets[i], 1, r.deviation, r.run);
      made::add(alike, test.targets[i], -1, r.deviation + 1e-6 * static_cast<double>(i % 5), r.run);
    }
  const ByName v = by_every_rule(alike);
  EXPECT_NEAR(v.at("vdi-3441:P"), v.at("iso-1988:A"), nothing);
  EXPECT_NEAR(v.at("vdi-3441:PsU_max"), v.at("iso-1988:R"), nothing);
}

TEST_P(AxisProperties, OneDirectionGivesWhatItCanAndNoMore) {
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const Observations& o = s.observations;
  Observations up;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (o.axes[0].approach[i] > 0)
      made::add(up, o.axes[0].position[i], 1, o.deviation[i], o.run[i]);
  const ByName both = by_every_rule(o);
  for (const auto& [name, value] : by_every_rule(up)) {
    const bool of_plus =
        name.ends_with('+') || (name.starts_with("jis-63") && !name.ends_with("motion"));
    EXPECT_EQ(std::isfinite(value), of_plus) << name;
    if (name.ends_with('+') && !name.starts_with("nmtba-no")) {
      EXPECT_EQ(value, both.at(name)) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Random, AxisProperties, testing::Range<std::uint64_t>(1, 101));

// Two passes: a common offset of a million metres leaves what doubles leave of micrometres.
// Readings are multiples of 2^-30 m, so that they stay exact with the offset added.
TEST(Numbers, ALargeOffsetKeepsTheDigits) {
  const double grid = std::ldexp(1.0, -30);  // 0.93 nm
  made::Random random(7);
  Observations near, far;
  for (std::uint32_t run = 1; run <= 5; ++run)
    for (int i = 0; i < 11; ++i)
      for (const int d : {1, -1}) {
        const double x = grid * std::round(1e-6 * made::normal(random) / grid);
        made::add(near, 0.1 * i, d, x, run);
        made::add(far, 0.1 * i, d, x + 1e6, run);
      }
  ASSERT_EQ(far.deviation[0] - 1e6, near.deviation[0]);
  const auto a = list(math::evaluate_iso230_2(AxisTest::arrange(near), 2.0));
  const auto b = list(math::evaluate_iso230_2(AxisTest::arrange(far), 2.0));
  // The mean itself is rounded to the spacing of doubles at 1e6 m, 0.12 nm; a range takes two.
  expect_near(a, b, 3e-10);
  // s does not depend on where the mean was rounded to.
  const auto p = math::evaluate_iso230_2(AxisTest::arrange(near), 2.0).points;
  const auto q = math::evaluate_iso230_2(AxisTest::arrange(far), 2.0).points;
  for (std::size_t i = 0; i < p.size(); ++i)
    EXPECT_NEAR(p[i].s_plus, q[i].s_plus, 1e-9 * p[i].s_plus);
}

}  // namespace
}  // namespace nonio::axis_properties_test
