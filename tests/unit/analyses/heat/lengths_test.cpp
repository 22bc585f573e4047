// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "made_heat.h"

using namespace nonio;
using namespace heat;

namespace {

const std::map<std::string, Setting, std::less<>> wide{{"mpe_E0_um", 20.0}, {"mpe_R0_um", 20.0}};

/// Points on a sphere of 12.5 mm, one of them out by `out`.
Made sphere(int n, double out) {
  Made t;
  begin(t, "lengths");
  t.o.axes = {{"point", false, {}, {}}};
  t.o.lines = {{"P", {}}};
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (i + 0.5) / n, s = std::sqrt(1.0 - z * z), a = 2.399963 * i;
    const double R = 12.5e-3 + (i == 7 ? out : 0.0);
    const std::array<double, 3> p{0.3 + R * s * std::cos(a), 0.2 + R * s * std::sin(a), R * z};
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> sense{};
      sense[k] = 1.0;
      t.o.sense.push_back(sense), t.o.deviation.push_back(p[k]);
      t.o.axes[0].position.push_back(i + 1.0);
    }
  }
  return t;
}

}  // namespace

TEST(Lengths, UHoldsTheErrorsOfMachines) {
  constexpr std::uint64_t seed = 20261125;
  SCOPED_TRACE("seed " + std::to_string(seed));
  for (const auto& [name, c] : lengths_coverage(100, seed)) {
    EXPECT_EQ(c.all, 100) << name;
    EXPECT_GE(c.within, 85) << name;
  }
}

TEST(Lengths, ThreeAnswers) {
  Random r(1);
  const MadeLengths m = gauging(r, 1e-6);
  EXPECT_NE(finding(evaluated(lengths(), m.test, wide), "lengths.conforms"), nullptr);
  for (const char* judged : {"E0", "R0"})
    EXPECT_EQ(value(evaluated(lengths(), m.test, wide), judged)->judged->decision,
              Decision::conforms);
  // At its own largest error the limit is nearer than U.
  const auto e = evaluated(lengths(), m.test, wide);
  const double largest = std::max(value(e, "E0_max")->value, -value(e, "E0_min")->value);
  const auto near = evaluated(lengths(), m.test, {{"mpe_E0_um", largest * 1e6}});
  const Finding* f = finding(near, "lengths.cannot-be-decided");
  ASSERT_NE(f, nullptr);
  EXPECT_TRUE(f->attention);
  EXPECT_GT(evidence(*f, "undecided"), 0.0);
  EXPECT_EQ(value(near, "E0")->judged->decision, Decision::cannot_be_decided);
  EXPECT_NEAR(value(near, "E0")->judged->limit, largest, 0.6e-9);
  // An accredited laboratory decides with at least its CMC, which the result has too.
  MadeLengths accredited = m;
  accredited.test.campaign.laboratory.accreditation = "LAT 123";
  accredited.test.campaign.laboratory.cmc.fixed = 1e-3;
  EXPECT_NE(finding(evaluated(lengths(), accredited.test, wide), "lengths.cannot-be-decided"),
            nullptr);
  const auto far = evaluated(lengths(), m.test, {{"mpe_E0_um", largest * 1e6 - 1.0}});
  const Finding* beyond = finding(far, "lengths.does-not-conform");
  ASSERT_NE(beyond, nullptr);
  EXPECT_GT(evidence(*beyond, "outside"), 0.0);
}

TEST(Lengths, WithoutUNothingIsDecided) {
  Random r(2);
  MadeLengths m = gauging(r, 1e-6);
  m.test.campaign.instrument.U_per_length.reset();
  const auto e = evaluated(lengths(), m.test, wide);
  EXPECT_NE(finding(e, "lengths.no-uncertainty"), nullptr);
  EXPECT_NE(finding(e, "uncertainty.no-data"), nullptr);
  EXPECT_EQ(finding(e, "lengths.conforms"), nullptr);
  EXPECT_FALSE(value(e, "E0_max")->U);
}

TEST(Lengths, WithoutALimitNothingIsDecided) {
  Random r(2);
  const auto e = evaluated(lengths(), gauging(r, 1e-6).test);
  EXPECT_NE(finding(e, "lengths.no-limit"), nullptr);
  EXPECT_EQ(value(e, "E0"), nullptr);
  EXPECT_NE(value(e, "E0_max"), nullptr);
}

TEST(Lengths, ATemperatureOfTheGaugeCountsWhereItExpands) {
  Random r(3);
  MadeLengths m = gauging(r, 1e-6);
  const auto cold = evaluated(lengths(), m.test, wide);
  auto& c = m.test.campaign;
  c.instrument.expansion = 11.5e-6, c.instrument.temperature_range = 0.5,
  c.instrument.expansion_range = 1e-6;
  const auto no_room = evaluated(lengths(), m.test, wide);
  EXPECT_NE(finding(no_room, "uncertainty.no-data"), nullptr) << "how far from 20 degC?";
  c.environment.temperature_difference = 1.0;
  const auto warm = evaluated(lengths(), m.test, wide);
  EXPECT_GT(*value(warm, "E0")->U, 1.2 * *value(cold, "E0")->U);
  c.environment.temperature_range = 5.0, c.environment.expansion_range = 1e-6;
  EXPECT_DOUBLE_EQ(*value(evaluated(lengths(), m.test, wide), "E0")->U, *value(warm, "E0")->U)
      << "the temperature of the machine is in its errors";
}

TEST(Lengths, APartOfThePlanSaysSo) {
  Random r(4);
  MadeLengths m = gauging(r, 1e-6);
  EXPECT_EQ(finding(evaluated(lengths(), m.test, wide), "lengths.plan"), nullptr);
  std::vector<char> kept(m.test.o.size(), 1);
  for (std::size_t i = 0; i < kept.size(); ++i)
    kept[i] = m.test.o.line[i] < 3 && m.test.o.run[i] < 2;
  keep_rows(m.test.o, kept);
  const auto e = evaluated(lengths(), m.test, wide);
  const Finding* f = finding(e, "lengths.plan");
  ASSERT_NE(f, nullptr);
  EXPECT_EQ(evidence(*f, "positions"), 3.0);
  EXPECT_EQ(evidence(*f, "repeats"), 1.0);
  EXPECT_EQ(value(e, "R0"), nullptr);
  EXPECT_NE(finding(e, "lengths.no-repeats"), nullptr);
}

TEST(Lengths, FormOnASphere) {
  Made t = sphere(25, 2e-6);
  t.campaign.instrument.sphere = 0.1e-6;
  auto e = evaluated(lengths(), t, {{"mpe_P_um", 5.0}});
  ASSERT_NE(value(e, "P_form"), nullptr);
  EXPECT_GT(value(e, "P_form")->value, 1.5e-6);
  EXPECT_LT(value(e, "P_form")->value, 2.2e-6);
  EXPECT_NE(finding(e, "lengths.conforms"), nullptr);
  EXPECT_EQ(finding(e, "lengths.points-of-plan"), nullptr);
  t.campaign.instrument.sphere.reset();
  EXPECT_NE(finding(evaluated(lengths(), t, {{"mpe_P_um", 5.0}}), "lengths.no-uncertainty"),
            nullptr);
  EXPECT_NE(finding(evaluated(lengths(), sphere(4, 0.0)), "lengths.refused-sphere"), nullptr);
}

TEST(Lengths, HostileReadingsAreNoCrashAndNoNumber) {
  Random r(5);
  MadeLengths m = gauging(r, 1e-6);
  for (const double d : {0.0, -1e20}) {
    m.test.o.deviation.assign(m.test.o.size(), d);
    for (const Value& v : evaluated(lengths(), m.test, wide).values)
      EXPECT_TRUE(std::isfinite(v.value));
  }
  m.test.o = rearranged(m.test.o, {});
  EXPECT_TRUE(evaluated(lengths(), m.test, wide).values.empty());
}
