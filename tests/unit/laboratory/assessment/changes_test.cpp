// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/changes.h"

#include <gtest/gtest.h>

#include <iostream>

#include "made.h"

namespace nonio::test::changes_test {
namespace {

using Cause = nonio::statistics::Change::Cause;

/// Quiet machines, three axes of three quantities each.
std::vector<assessment::AssessedMachine> quiet(std::mt19937_64& random, std::size_t machines) {
  std::vector<assessment::AssessedMachine> out;
  for (std::size_t k = 0; k < machines; ++k) {
    MadeMachine m("S-" + std::to_string(k));
    for (const char* axis : {"X", "Y", "Z"})
      for (const char* quantity : {"B_mean", "curve_2", "ln_s"})
        m.follow(axis, quantity, around(random, 8, 0.1), 0.1);
    out.push_back(m.assessed());
  }
  return out;
}

std::size_t significant(const std::vector<assessment::AssessedMachine>& machines) {
  std::size_t n = 0;
  for (const auto& m : machines)
    for (const auto& s : m.followed)
      n += std::count(s.significant.begin(), s.significant.end(), true);
  return n;
}

TEST(WorklistChanges, AStepIsNamedAtItsPlaceWithItsOtherEffects) {
  std::mt19937_64 random(11);
  std::cout << "seed 11\n";
  auto machines = quiet(random, 12);
  MadeMachine hit("S-HIT");
  hit.follow("X", "B_mean", around(random, 8, 0.1, 4, -1.0), 0.1);
  hit.follow("X", "curve_2", around(random, 8, 0.1, 4, 0.3), 0.1);  // alone it would be too small
  hit.follow("Y", "B_mean", around(random, 8, 0.1), 0.1);
  machines.push_back(hit.assessed());
  judge_all(machines);
  const auto& m = machines.back();
  for (std::size_t i : {0U, 1U}) {
    const auto& s = m.followed[i];
    ASSERT_EQ(std::count(s.significant.begin(), s.significant.end(), true), 1) << s.quantity;
    for (std::size_t k = 0; k < s.significant.size(); ++k)
      if (s.significant[k]) {
        EXPECT_EQ(s.trend.changes[k].after, 3U);
        EXPECT_EQ(s.trend.changes[k].cause, Cause::undeclared);
        EXPECT_NEAR(s.trend.changes[k].size, i == 0 ? -1.0 : 0.3, 0.25);
      }
  }
  EXPECT_EQ(significant({m}), 2U);
}

TEST(WorklistChanges, ARenamedCampaignCountsOnce) {
  MadeMachine m("S-1", 4);
  m.follow("X", "B_mean", {-5.1, -5.0, -5.2, -5.15}, 0.1);
  m.add_campaign(MadeMachine::day(3), 2);
  store::StoredResult renamed = m.stored().results.back();
  renamed.campaign = 4;
  m.stored().results.push_back(renamed);
  auto series = m.series();
  ASSERT_EQ(series.size(), 1U);
  ASSERT_EQ(series[0].results.size(), 4U);
  EXPECT_EQ(m.stored().results[series[0].results.back()].campaign, 4U);
  m.stored().results.back().value = -5.16;  // other readings of the same day
  EXPECT_EQ(m.series()[0].results.size(), 5U);
}

TEST(WorklistChanges, WhatIsKnownIsNotSaidToBeUnknown) {
  std::mt19937_64 random(12);
  std::cout << "seed 12\n";
  auto machines = quiet(random, 12);
  MadeMachine hit("S-HIT");
  hit.follow("X", "B_mean", around(random, 8, 0.1, 4, -1.0), 0.1);
  hit.events() = {{"2021-10-01", "S-HIT", "X", "crash", "vice", "", 1}};
  machines.push_back(hit.assessed());
  judge_all(machines);
  const auto& s = machines.back().followed[0];
  ASSERT_EQ(s.trend.changes.size(), 1U);
  EXPECT_TRUE(s.significant[0]);
  EXPECT_EQ(s.trend.changes[0].cause, Cause::event);
}

TEST(WorklistChanges, AnInstrumentIsNotTheMachine) {
  std::mt19937_64 random(13);
  std::cout << "seed 13\n";
  std::size_t blamed = 0;
  for (int lab = 0; lab < 100; ++lab) {
    MadeMachine m("S-1");
    m.follow("X", "scale", around(random, 8, 0.1, 5, 1.0),
             0.1);  // two of its standard uncertainties
    for (std::size_t i = 0; i < 8; ++i)
      m.stored().results[i].common = {{i < 5 ? "instrument 1" : "instrument 2", 0.5}};
    std::vector<assessment::AssessedMachine> machines{m.assessed()};
    judge_all(machines);
    const auto& s = machines[0].followed[0];
    for (std::size_t i = 0; i < s.significant.size(); ++i)
      blamed += s.significant[i] && s.trend.changes[i].after == 4 &&
                s.trend.changes[i].cause != Cause::instrument;
  }
  EXPECT_EQ(blamed, 0U);
}

TEST(WorklistChanges, QuietRunsReportNothing) {
  // The share of runs with any change is 5 %; of 200 runs at most 18 with a probability of 0.995.
  std::mt19937_64 random(14);
  std::cout << "seed 14\n";
  int runs = 0;
  for (int run = 0; run < 200; ++run) {
    auto machines = quiet(random, 4);
    judge_all(machines);
    runs += significant(machines) > 0;
  }
  EXPECT_LE(runs, 18);
}

TEST(WorklistChanges, ScatterAndSlopesAreLearnedFromTheLaboratory) {
  std::mt19937_64 random(15);
  std::cout << "seed 15\n";
  std::vector<assessment::AssessedMachine> machines;
  std::normal_distribution<double> wear(0.0, 0.5);
  for (int k = 0; k < 60; ++k) {
    MadeMachine m("S-" + std::to_string(k));
    auto values = around(random, 8, 0.2);  // twice what it says
    const double slope = wear(random);
    for (std::size_t i = 0; i < 8; ++i) values[i] += slope * 0.5 * static_cast<double>(i);
    m.follow("X", "B_mean", values, 0.1);
    m.follow("X", "ln_s", around(random, 8, 0.1), 0.1);
    machines.push_back(m.assessed());
  }
  assessment::Fits fits;
  const auto learned = assessment::learn(machines, fits);
  EXPECT_NEAR(learned.at("B_mean um").excess, 2.0, 0.3);
  EXPECT_NEAR(learned.at("B_mean um").spread, 0.5, 0.15);
  EXPECT_NEAR(learned.at("ln_s um").excess, 1.0, 0.15);
  EXPECT_LT(learned.at("ln_s um").spread, 0.05);
}

TEST(WorklistChanges, OfVeryManyCampaignsTheNewestWait) {
  // 100,000 campaigns or more are judged by the first 100,000, until there are 110,000.
  EXPECT_EQ(assessment::learned_from(100'000), 100'000U);
  EXPECT_EQ(assessment::learned_from(109'999), 100'000U);
  EXPECT_EQ(assessment::learned_from(110'000), 110'000U);
  EXPECT_EQ(assessment::learned_from(12'345), 12'000U);
  EXPECT_GE(assessment::learned_from(9'999), 1'000'000'000U);
}

TEST(WorklistChanges, WhatCameLaterTeachesNothing) {
  std::mt19937_64 random(17);
  std::cout << "seed 17\n";
  auto values = around(random, 8, 0.1);
  const auto series = [](const std::vector<double>& v) {
    MadeMachine m("S-1", v.size());
    m.follow("X", "B_mean", v, 0.1);
    for (std::size_t i = 8; i < v.size(); ++i) m.stored().results[i].u_repeat = 0.4;  // is pooled
    assessment::FollowedSeries s = m.assessed().followed.front();
    s.evaluations.resize(v.size());
    std::iota(s.evaluations.begin(), s.evaluations.end(), std::uint64_t{1});
    return s;
  };
  assessment::Fits fits;
  const assessment::Lesson known = assessment::lesson_of(series(values), fits);
  for (const double later : {5.0, -9.0, 7.0, 40.0}) values.push_back(later);
  const std::size_t computed = fits.computed();
  const assessment::Lesson first = assessment::lesson_of(series(values), fits, 8);
  ASSERT_TRUE(known.slope && first.slope);
  EXPECT_EQ(first.ratios, known.ratios);
  EXPECT_EQ(first.slope->b, known.slope->b);
  EXPECT_EQ(fits.computed(), computed) << "a night would compute it again";
  EXPECT_NE(assessment::lesson_of(series(values), fits).ratios, known.ratios);
  EXPECT_EQ(assessment::lesson_of(series(values), fits, 0).slope.has_value(), false);
}

TEST(WorklistChanges, ARunChargesATestOnce) {
  // The tests of one run over many machines are a family; a later run over one machine is another.
  std::mt19937_64 random(16);
  std::cout << "seed 16\n";
  const auto values = around(random, 8, 0.1, 4, 0.3);
  MadeMachine early("S-1", 8, 1), late("S-1", 8, 2);
  early.follow("X", "B_mean", values, 0.1);
  late.follow("X", "B_mean", values, 0.1);
  std::vector<assessment::AssessedMachine> one{early.assessed()}, other{late.assessed()};
  assessment::Fits fits;
  for (auto* machines : {&one, &other}) assessment::learn(*machines, fits);
  const std::map<std::uint64_t, std::uint64_t> asked{{1, 1000}, {2, 2}};
  assessment::find_changes(one, asked, fits, not_asked);
  assessment::find_changes(other, asked, fits, not_asked);
  EXPECT_TRUE(one[0].followed[0].trend.changes.empty()) << "what is not told bends no line";
  ASSERT_EQ(other[0].followed[0].significant, std::vector<bool>{true});
  const double p = other[0].followed[0].trend.changes[0].p;
  EXPECT_DOUBLE_EQ(other[0].followed[0].p_adjusted[0], 2.0 * p);
  EXPECT_GE(1000.0 * p, 0.05);
}

TEST(WorklistChanges, AMailIsSurerThanAList) {
  // The same history in runs with more and more tests: reported below 5 %, mailed below 1 %.
  std::mt19937_64 random(17);
  std::cout << "seed 17\n";
  const auto values = around(random, 8, 0.1, 4, 0.5);
  const auto after = [&](std::uint64_t asked) {
    MadeMachine m("S-1");
    m.follow("X", "B_mean", values, 0.1);
    std::vector<assessment::AssessedMachine> machines{m.assessed()};
    assessment::Fits fits;
    assessment::learn(machines, fits);
    assessment::find_changes(machines, {{1, asked}}, fits, not_asked);
    return machines[0].followed[0];
  };
  const double p = after(1).p_adjusted.at(0);
  ASSERT_LT(p, 1e-4);
  const auto of = [&](double level) { return static_cast<std::uint64_t>(level / p); };
  for (const auto& [asked, significant, mailed] :
       {std::tuple(of(0.0099), true, true), std::tuple(of(0.0101) + 1, true, false),
        std::tuple(of(0.0499), true, false), std::tuple(of(0.0501) + 1, false, false)}) {
    const auto s = after(asked);
    EXPECT_EQ(s.significant, std::vector<bool>(significant ? 1 : 0, true)) << asked;
    EXPECT_EQ(s.mailed, std::vector<bool>(significant ? 1 : 0, mailed)) << asked;
  }
}

TEST(WorklistChanges, AMailCountsAllThatItCouldReport) {
  // Holm over both families: of two news alike the list is as sure as of one, the mail is not.
  const assessment::SeriesTests said{1, true, {{1e-3, true, false}}},
      unsaid{1, true, {{2e-3, false, false}}}, quiet{1, true, {}};
  const auto adjusted = assessment::adjusted_by_run({&said, &unsaid, &quiet}, {{1, 9}});
  EXPECT_DOUBLE_EQ(adjusted[0][0].news, 1e-3);
  EXPECT_DOUBLE_EQ(adjusted[1][0].news, 9 * 2e-3);
  EXPECT_DOUBLE_EQ(adjusted[0][0].any, 10 * 1e-3);
  EXPECT_DOUBLE_EQ(adjusted[1][0].any, 9 * 2e-3);
}

}  // namespace
}  // namespace nonio::test::changes_test
