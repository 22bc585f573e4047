// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/proposals.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "made.h"

namespace nonio::test::proposals_test {
namespace {

using reports::IntervalProposal;
using Due = std::map<std::string, int>;

/// Yearly campaigns of `name`, judged by B.
MadeMachine yearly(const std::string& name, const std::vector<double>& B) {
  MadeMachine m(name, 0);
  for (std::size_t i = 0; i < B.size(); ++i)
    m.add_campaign(assessment::months_later("2020-01-15", 12 * static_cast<int>(i)), 1);
  m.judge("X", "B", B);
  return m;
}

/// And what failed was adjusted in the same campaign.
MadeMachine adjusted(MadeMachine m) {
  store::StoredResult left = m.stored().results.back();
  left.state = "as-left", left.decision = "conforms", left.value = 2.0;
  m.stored().results.push_back(left);
  return m;
}

std::vector<IntervalProposal> proposed(const std::vector<MadeMachine>& machines,
                                       const Due& due = {}) {
  std::vector<assessment::AssessedMachine> assessed;
  for (const MadeMachine& m : machines) assessed.push_back(m.assessed());
  judge_all(assessed);
  std::vector<assessment::IntervalFacts> facts;
  for (const auto& m : assessed) {
    auto rule = due.find(m.state.machine.name);
    if (rule == due.end()) rule = due.find("");
    facts.push_back(assessment::interval_facts(
        m, rule == due.end() ? std::nullopt : std::optional(rule->second)));
  }
  std::vector<const assessment::IntervalFacts*> all;
  for (const auto& f : facts) all.push_back(&f);
  return assessment::proposals_of(all);
}

double number(const IntervalProposal& p, const std::string& name) {
  for (const Number& n : p.why.evidence)
    if (n.name == name) return n.value;
  return -1.0;
}

std::string why(const IntervalProposal& p) { return p.why.id; }

TEST(Proposals, HalfAfterAFailureALittleMoreAfterASuccess) {
  const auto p = proposed(
      {yearly("S-1", {5, 5, 5}), adjusted(yearly("S-2", {5, 5, 9})), yearly("S-3", {5, 5, 8})});
  EXPECT_EQ(why(p[0]), "interval.passed");
  EXPECT_EQ(p[0].months, 12);  // 12.45: whole months, down
  EXPECT_EQ(p[0].method, "staircase");
  EXPECT_EQ(why(p[1]), "interval.failed");
  EXPECT_EQ(p[1].months, 6);
  EXPECT_EQ(number(p[1], "interval"), 12.0);
  EXPECT_EQ(why(p[2]), "interval.undecided");
  EXPECT_EQ(p[2].months, 12);
}

TEST(Proposals, BeginWithTheRuleOfTheSite) {
  MadeMachine m("S-1", 0);
  for (const char* day : {"2018-01-15", "2020-11-15", "2023-11-15"}) m.add_campaign(day, 1);
  m.judge("X", "B", {5, 5, 5});
  const std::vector<MadeMachine> one{m};
  EXPECT_EQ(proposed(one, {{"", 36}})[0].months, 37);  // 36 * 2^(0.05/0.95) = 37.34
  EXPECT_EQ(proposed(one, {{"", 36}, {"S-1", 24}})[0].months, 24);
}

TEST(Proposals, AMachineThatWasMeasuredEarlyHasNotShownItsInterval) {
  const auto p = proposed(
      {yearly("S-1", {5, 5, 5}), adjusted(yearly("S-2", {5, 5, 9})), yearly("S-3", {5, 5, 8})},
      {{"", 36}});
  EXPECT_EQ(why(p[0]), "interval.early");
  EXPECT_EQ(p[0].months, 36);
  EXPECT_EQ(number(p[0], "tested"), 12.0);
  EXPECT_EQ(why(p[1]), "interval.failed");  // after 12 months, whatever the rule is
  EXPECT_EQ(p[1].months, 6);
  EXPECT_EQ(number(p[1], "interval"), 12.0);
  EXPECT_EQ(why(p[2]), "interval.undecided");
  EXPECT_EQ(p[2].months, 36);
  // 12 of 15 months are nearly its interval.
  EXPECT_EQ(why(proposed({yearly("S-1", {5, 5, 5})}, {{"", 15}})[0]), "interval.passed");
}

TEST(Proposals, WhatWasLeftIsNoReason) {
  EXPECT_EQ(why(proposed({adjusted(yearly("S-1", {5, 5, 9}))})[0]), "interval.failed");
}

TEST(Proposals, NoIntervalHelpsWhatIsOutNow) {
  const IntervalProposal p = proposed({yearly("S-1", {5, 5, 9})}, {{"", 12}})[0];
  EXPECT_EQ(why(p), "interval.out-now");
  EXPECT_FALSE(p.months);
  EXPECT_EQ(p.axis + " " + p.quantity, "X B");
  EXPECT_NEAR(number(p, "limit"), 8e-6, 1e-12);
}

TEST(Proposals, AreRefusedByName) {
  const auto refusal = [](const MadeMachine& m) {
    const IntervalProposal p = proposed({m})[0];
    EXPECT_FALSE(p.months);
    EXPECT_FALSE(p.method.empty());
    return why(p);
  };
  EXPECT_EQ(refusal(yearly("S-1", {5})), "interval.few-campaigns");
  MadeMachine free = yearly("S-1", {5, 5, 5});
  for (auto& r : free.stored().results) r.tolerance.reset(), r.decision.clear();
  EXPECT_EQ(refusal(free), "interval.not-judged");
  // Hit before the last campaign: no forecast is possible.
  MadeMachine hit = yearly("S-1", {5, 5, 5, 5, 5, 5, 5, 6});
  hit.follow("X", "B_mean", {-3, -3.1, -2.9, -3, -3.1, -2.9, -3, -6}, 0.1);
  EXPECT_EQ(refusal(hit), "interval.change-not-explained");
  // It wears by 1 um per year and has reached 7.95 of 8 um.
  MadeMachine worn = yearly("S-1", {0.95, 1.95, 2.95, 3.95, 4.95, 5.95, 6.95, 7.95});
  worn.follow("X", "B_mean", {-0.95, -1.95, -2.95, -3.95, -4.95, -5.95, -6.95, -7.95}, 0.02);
  EXPECT_EQ(refusal(worn), "interval.out-already");
}

TEST(Proposals, WhatNoTestConfirmedIsNoReasonToRefuse) {
  // A step with p of about 0.01 alone is not significant among the many tests of one run.
  std::mt19937_64 random(21);
  MadeMachine odd = yearly("S-1", {5, 5, 5, 5, 5, 5, 5, 5});
  odd.follow("X", "B_mean", {-3, -3.1, -2.9, -3, -3.1, -2.9, -3, -3.39}, 0.1);
  std::vector<MadeMachine> machines{odd};
  for (int i = 0; i < 40; ++i) {
    machines.push_back(yearly("T-" + std::to_string(100 + i), {5, 5, 5, 5, 5, 5, 5, 5}));
    machines.back().follow("X", "B_mean", around(random, 8, 0.1), 0.1);
  }
  std::vector<assessment::AssessedMachine> assessed;
  for (const MadeMachine& m : machines) assessed.push_back(m.assessed());
  judge_all(assessed);
  const auto& s = assessed[0].followed[0];
  EXPECT_TRUE(s.significant.empty());
  nonio::statistics::Series alone = s.series;
  alone.steps.reset();
  const auto trend = nonio::statistics::trend_of(alone);
  ASSERT_EQ(trend->changes.size(), 1U);
  ASSERT_EQ(trend->changes[0].after, 6U);
  EXPECT_TRUE(proposed(machines)[0].months) << why(proposed(machines)[0]);
}

TEST(Proposals, AnEventThatChangedNothingIsNoReasonToRefuse) {
  MadeMachine m = yearly("S-1", {5, 5, 5, 5, 5, 5, 5, 5});
  m.follow("X", "B_mean", {-3, -3.1, -2.9, -3, -3.1, -2.9, -3, -3.1}, 0.1);
  m.events() = {{"2026-06-01", "S-1", "X", "software", "control 4.8", "", 1}};
  EXPECT_TRUE(proposed({m})[0].months) << why(proposed({m})[0]);
}

TEST(Proposals, ATrendShortensTheInterval) {
  // 1 um a year, 5 um now, limit 8 um: before three years are over, and 36 months are the rule.
  MadeMachine m = yearly("S-1", {2, 1, 0, 1, 2, 3, 4, 5});
  m.follow("X", "B_mean", {2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0}, 0.05);
  for (auto& r : m.stored().results)
    if (r.followed) r.value -= 4.0;
  const IntervalProposal p = proposed({m}, {{"", 48}})[0];
  EXPECT_EQ(why(p), "interval.meets-limit");
  EXPECT_EQ(p.method, "control-chart");
  EXPECT_EQ(p.axis + " " + p.quantity, "X B");
  ASSERT_TRUE(p.months);
  EXPECT_GE(*p.months, 30);
  EXPECT_LE(*p.months, 35);
  EXPECT_NEAR(number(p, "limit"), 8e-6, 1e-12);
  EXPECT_EQ(why(proposed({m}, {{"", 12}})[0]), "interval.passed");  // sooner than that
}

TEST(Proposals, OfManyLikeMachinesTheFleetIsAsked) {
  // Golden: 15 of 20 in tolerance, target 95 %, 365 days: 230.85 days.
  std::vector<MadeMachine> machines;
  for (int i = 0; i < 20; ++i)
    machines.push_back(i < 5 ? adjusted(yearly("S-" + std::to_string(100 + i), {5, 5, 9}))
                             : yearly("S-" + std::to_string(100 + i), {5, 5, 5}));
  auto p = proposed(machines);
  EXPECT_EQ(why(p[19]), "interval.fleet-shorter");
  EXPECT_EQ(p[19].method, "fleet");
  EXPECT_EQ(p[19].months, 7);  // 12 * 230.85 / 365 = 7.59
  EXPECT_EQ(number(p[19], "passed"), 15.0);
  EXPECT_EQ(number(p[19], "machines"), 20.0);
  EXPECT_EQ(p[0].months, 6) << "failed itself: not more than half";
  for (MadeMachine& m : machines)
    for (auto& r : m.stored().results) r.value = 5.0, r.decision = "conforms";
  p = proposed(machines);
  EXPECT_EQ(why(p[19]), "interval.fleet-longer");
  EXPECT_GT(*p[19].months, 12);
  machines.erase(machines.begin() + 4, machines.end());
  EXPECT_EQ(why(proposed(machines)[0]), "interval.passed") << "four are no fleet";
}

}  // namespace
}  // namespace nonio::test::proposals_test
