// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "campaign/config/manifest.h"
#include "made_laboratory.h"
#include "nonio/reports/history_value.h"
#include "nonio/sdk/format.h"

namespace nonio::test::lines_test {
namespace {

TEST(WorklistLines, AcknowledgedIsKnownUntilItMoves) {
  Laboratory lab;
  lab.machines.push_back(hit());
  for (const char* finding : {"worklist.out:S-42:X", "worklist.out-changed", "worklist.out"}) {
    lab.logs.acknowledged = {acknowledged(finding, "2024-01-01")};
    EXPECT_EQ(lab.lines()[0].state, State::known) << finding;
  }
  EXPECT_EQ(lab.lines()[0].by, "B. Sample");
  EXPECT_EQ(lab.lines()[0].until, "2024-12-31");
  lab.logs.acknowledged[0].until = "2024-05-31";
  EXPECT_EQ(lab.lines()[0].state, State::fresh) << "past its day";
  lab.logs.acknowledged = {acknowledged("worklist.out", "2024-01-01")};
  lab.logs.acknowledged[0].axis = "Y";
  EXPECT_EQ(lab.lines()[0].state, State::fresh) << "another axis";
  // Before it happened: of another cause.
  lab.logs.acknowledged = {acknowledged("worklist.out", "2022-03-01")};
  EXPECT_EQ(lab.lines()[0].state, State::fresh) << "later change";
  // Moved by more than its U of 0.5 um since.
  lab.logs.acknowledged = {acknowledged("worklist.out", "2023-08-01")};
  auto& results = lab.machines[0].stored().results;
  const auto last = std::find_if(results.rbegin(), results.rend(),
                                 [](const auto& r) { return r.quantity == "B"; });
  last->campaign = 7;
  lab.machines[0].stored().campaigns[7].day = "2024-01-15";
  last->value = 10.4;
  EXPECT_EQ(lab.lines()[0].state, State::known);
  last->value = 10.7;
  EXPECT_EQ(lab.lines()[0].state, State::fresh) << "moved";
  lab.logs.acknowledged[0].value = 10.6;
  EXPECT_EQ(lab.lines()[0].state, State::known) << "from what was acknowledged";
}

TEST(WorklistLines, WhatConformsAgainInThisRunIsFixed) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("X", "B", {9, 9, 9, 9, 9, 9, 9, 5});
  m.stored().campaigns[7].run = 5;
  lab.machines.push_back(std::move(m));
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].state, State::fixed);
  lab.last_run.run = 6;  // told once
  EXPECT_TRUE(lab.lines().empty());
}

TEST(WorklistLines, ARepairThatIsPlannedHasFixedNothing) {
  Laboratory lab;
  lab.machines.push_back(hit(6.0, -5.5));
  lab.machines[0].events() = {{"2024-06-02", "S-42", "X", "repair", "nut is ordered", "", 1}};
  ASSERT_EQ(lab.lines().size(), 1U);
  EXPECT_EQ(lab.lines()[0].kind, Kind::changed);
  lab.last_run.date = "2024-06-02";
  EXPECT_TRUE(lab.lines().empty());
}

TEST(WorklistLines, ACampaignDatedAfterTheRunIsNamed) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("X", "B", {5, 5, 5, 5, 5, 5, 5, 5});
  m.stored().later = {{"S-42-9", "2042-06-01"}};  // meant is 2024
  lab.machines.push_back(m);
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].id, "worklist.later:S-42:S-42-9");
  EXPECT_EQ(lines[0].kind, Kind::undecided);
  EXPECT_EQ(text_of(lines[0], "day"), "2042-06-01");
  for (int k = 0; k < 3; ++k) lab.machines.push_back(m);  // the clock was set back
  lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].finding.id, "worklist.later-several");
}

TEST(WorklistLines, AnotherDefinitionOrAWiderLimitFixesNothing) {
  const auto significant = [](auto change) {
    Laboratory lab;
    MadeMachine m("S-42");
    m.judge("X", "A", {9, 9, 9, 9, 9, 9, 9, 5});
    m.stored().campaigns[7].run = 5;
    change(m.stored().results);
    lab.machines.push_back(std::move(m));
    const auto lines = lab.lines();
    return lines.size() == 1 ? lines[0].finding.id : std::to_string(lines.size()) + " lines";
  };
  EXPECT_EQ(significant([](auto&) {}), "worklist.fixed");
  EXPECT_EQ(significant([](auto& r) { r[7].tolerance = 7.0; }), "worklist.fixed");
  EXPECT_EQ(significant([](auto& r) { r[7].tolerance = 12.0; }), "worklist.judged-anew");
  EXPECT_EQ(significant([](auto& r) {
              for (std::size_t i = 0; i < 7; ++i) r[i].conditions = R"({"edition":1988})";
            }),
            "worklist.judged-anew");
}

TEST(WorklistLines, MicrometresAreNoArcseconds) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("C", "B", {9, 9, 9, 9, 9, 9, 5, 5});  // as a linear axis it did not conform
  m.follow("C", "B_mean", {-9, -9.1, -9, -8.9, -9, -9, -5, -5.1}, 0.1);
  for (auto& r : m.stored().results)
    if (r.campaign > 5) r.unit = "arcsec";
  lab.machines.push_back(std::move(m));
  EXPECT_TRUE(lab.lines().empty());
  const auto shown = assessment::describe(lab.machines[0].assessed(), "out", "", "");
  ASSERT_EQ(shown.series.size(), 4U);
  for (const reports::HistorySeries& s : shown.series) {
    const bool turns = s.unit == Quantity::angular_deviation;
    EXPECT_EQ(s.ended, !turns) << s.quantity;
    EXPECT_EQ(s.points.size(), turns ? 2U : 6U) << s.quantity;
  }
  // What was said of the one is nothing of the other.
  auto& results = lab.machines[0].stored().results;
  for (std::size_t i = 6; i < 8; ++i)
    results[i].value = 9.1, results[i].decision = "does not conform";
  lab.logs.acknowledged = {acknowledged("worklist.out", "2022-08-01")};
  lab.logs.acknowledged[0].axis = "C";
  ASSERT_EQ(lab.lines().size(), 1U);
  EXPECT_EQ(lab.lines()[0].unit, Quantity::angular_deviation);
  EXPECT_EQ(lab.lines()[0].state, State::known);
}

TEST(WorklistLines, NamesThatNoCampaignHasAreSaid) {
  Laboratory lab;
  EXPECT_TRUE(lab.lines().empty());
  lab.unknown = {"S-4Z (events.toml:7)"};
  ASSERT_EQ(lab.lines().size(), 1U);
  EXPECT_EQ(lab.lines()[0].finding.id, "worklist.unknown-machine");
  EXPECT_EQ(text_of(lab.lines()[0], "where"), "S-4Z (events.toml:7)");
  EXPECT_FALSE(reports::asks(lab.lines()[0]));
}

/// As found and as left on 2023-07-15 with a table between them, which promised E = 0.8 um.
MadeMachine with_table(double E_left, std::size_t campaign = 7) {
  MadeMachine m("S-42");
  const auto result = [&](const char* quantity, const char* state, double value) {
    m.stored().results.push_back({.campaign = campaign,
                                  .measurement = std::string("X ") + state,
                                  .axis = "X",
                                  .quantity = quantity,
                                  .source = "iso230-2",
                                  .unit = "um",
                                  .state = state,
                                  .decision = "",
                                  .conditions = "",
                                  .value = value,
                                  .u_repeat = 0.1,
                                  .common = {{"instrument", 2.0}}});
  };
  result("E", "as-found", 13.7);
  result("E", "as-left", E_left);
  result("ln_s", "as-left", std::log(0.4));
  m.stored().results.back().followed = true;
  m.stored().predicted.push_back(m.stored().results[0]);
  m.stored().predicted[0].value = 0.8;
  return m;
}

TEST(WorklistLines, ATableThatDidNotDoWhatItPromisedIsADecision) {
  const auto table_lines = [](const MadeMachine& m) {
    Laboratory lab;
    lab.machines.push_back(m);
    auto lines = lab.lines();
    std::erase_if(lines, [](const WorkItem& l) { return l.finding.id != "worklist.table"; });
    return lines;
  };
  EXPECT_TRUE(table_lines(with_table(1.4)).empty()) << "within what its readings scatter";
  for (const double wrong : {27.0, 13.7}) {  // wrong sign; never loaded
    const auto lines = table_lines(with_table(wrong));
    ASSERT_EQ(lines.size(), 1U) << wrong;
    EXPECT_EQ(lines[0].kind, Kind::changed);
    EXPECT_EQ(lines[0].id, "worklist.table:S-42:X:S-42-8");
    EXPECT_NEAR(*lines[0].value, wrong * 1e-6, 1e-12);
    EXPECT_EQ(lines[0].finding.evidence.size(), 3U);
  }
  MadeMachine later = with_table(27.0);  // measured again since: what matters now is that
  later.add_campaign("2023-09-01", 1);
  later.stored().results.push_back(later.stored().results[0]);
  later.stored().results.back().campaign = 8;
  EXPECT_TRUE(table_lines(later).empty());
  MadeMachine old = with_table(27.0);  // promised half a year before
  old.stored().predicted[0].campaign = 6;
  EXPECT_TRUE(table_lines(old).empty());
}

TEST(WorklistLines, OfGoodTablesOneInAHundredIsDoubtedAtMost) {
  std::cout << "seed 20261123\n";
  std::mt19937_64 random(20261123);
  for (const int runs : {2, 5})
    for (const int targets : {5, 21, 41}) {
      // Nothing but scatter is left, and the table had promised exactly nothing.
      std::normal_distribution<double> mean(0.0, 1.0 / std::sqrt(runs));
      std::chi_squared_distribution<double> squares(2.0 * targets * (runs - 1));
      constexpr int trials = 2000;
      int doubted = 0;
      for (int i = 0; i < trials; ++i) {
        double low = 0.0, high = 0.0;
        for (int k = 0; k < 2 * targets; ++k) {
          const double x = mean(random);
          low = std::min(low, x), high = std::max(high, x);
        }
        MadeMachine m = with_table(high - low);
        m.stored().predicted[0].value = 0.0;
        for (auto& r : m.stored().results)
          if (r.followed)
            r.value = std::log(squares(random) / (2.0 * targets * (runs - 1))) / 2.0;
          else
            r.u_repeat = 1e-6;
        const auto kept = assessment::tables_kept(m.assessed());
        ASSERT_EQ(kept.size(), 1U);
        doubted += kept[0].good ? 0 : 1;
      }
      EXPECT_LE(doubted, trials / 100 + 14) << runs << " runs, " << targets << " targets";
    }
}

TEST(WorklistLines, LostMotionThatConformsIsInformation) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("X", "B", {5, 5, 5, 5, 5, 5, 5, 5});
  m.stored().findings.back() = {{"reversal.lost-motion", "attention"}};
  lab.machines.push_back(m);
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].kind, Kind::information);
  EXPECT_FALSE(lines[0].finding.attention);
  // Without a tolerance nothing was judged, which a line states.
  for (auto& r : lab.machines[0].stored().results) r.tolerance.reset(), r.decision.clear();
  lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].finding.id, "worklist.not-judged");
  EXPECT_EQ(text_of(lines[0], "machines"), "S-42");
}

TEST(WorklistLines, AreInTheirOrder) {
  Laboratory lab;
  lab.last_run.vanished = {{"gone", "gone", 4, "not there"}};
  const assessment::LastRun::Failed bad{"bad", "bad", "x.csv:17: \"1O8.9\" is no number", ""};
  lab.last_run.failed = {bad, bad};  // two folders with one id
  lab.machines = {hit(), MadeMachine("S-43"), MadeMachine("S-44"), MadeMachine("S-45")};
  lab.machines[1].follow("X", "B_mean", flat(-1.0, -3.0), 0.1);
  lab.machines[2].judge("X", "B", {7, 7, 7, 7, 7, 7, 7, 7.9});
  lab.machines[3].follow("X", "B_mean", {-1, -1.9, -3.1, -4, -5.1, -6, -7, -7.9}, 0.1);
  lab.machines[3].judge("X", "B", {1, 2, 3, 4, 5, 6, 7, 7.4});
  lab.due = "2024-03-01";
  const auto kinds = [&] {
    std::vector<Kind> out;
    for (const WorkItem& l : lab.lines())
      if (out.empty() || out.back() != l.kind || l.kind == Kind::failed) out.push_back(l.kind);
    return out;
  };
  EXPECT_EQ(kinds(),
            (std::vector<Kind>{Kind::lost, Kind::failed, Kind::out, Kind::changed, Kind::soon,
                               Kind::overdue, Kind::undecided, Kind::information}));
  lab.logs.acknowledged = {acknowledged("worklist.out", "2024-01-01")};
  EXPECT_EQ(kinds(),
            (std::vector<Kind>{Kind::lost, Kind::failed, Kind::changed, Kind::soon, Kind::overdue,
                               Kind::undecided, Kind::out, Kind::information}));
}

TEST(WorklistLines, TheWorstLineOfAnAxisDecidesAndWhatWasLeft) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("X", "B", {9, 9});  // out, at Y = 100; conforms at Y = 500, named later
  m.judge("X", "B", {5, 5});
  for (std::size_t i = 0; i < 4; ++i)
    m.stored().results[i].measurement = i < 2 ? "X at 100" : "X at 500";
  lab.machines.push_back(m);
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].kind, Kind::out);
  EXPECT_EQ(lines[0].since, "2020-01-15");
  // Found out and left good is good.
  for (std::size_t i = 2; i < 4; ++i) lab.machines[0].stored().results[i].state = "as-left";
  EXPECT_TRUE(lab.lines().empty());
}

TEST(WorklistLines, ACampaignWithoutTheLimitReplacesNothing) {
  Laboratory lab;
  MadeMachine m("S-42", 4);
  m.judge("X", "A", {5, 9, 9, 5});
  for (std::size_t i : {2, 3}) m.stored().results[i].decision.clear();
  for (std::size_t i : {2, 3}) m.stored().results[i].tolerance.reset();
  m.stored().results.push_back(
      m.stored().results[0]);  // another quantity of the axis, judged later
  m.stored().results.back().quantity = "B", m.stored().results.back().campaign = 3;
  lab.machines.push_back(m);
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].id + " " + lines[0].quantity, "worklist.out:S-42:X A");
  EXPECT_EQ(lines[0].campaign + " " + lines[0].since, "S-42-2 2020-07-15");
  // Judged again, it is closed.
  store::StoredResult& last = lab.machines[0].stored().results[3];
  last.tolerance = 8.0, last.decision = "conforms";
  EXPECT_TRUE(lab.lines().empty());
  // As left without the limit: what was found remains.
  last.tolerance.reset(), last.decision.clear(), last.state = "as-left";
  EXPECT_EQ(lab.lines().size(), 1U);
}

TEST(WorklistLines, OneOfTwoCampaignsOfADayReplacesTheOtherOnlyAsLeft) {
  Laboratory lab;
  MadeMachine m("S-42", 0);
  m.add_campaign("2024-01-15", 1), m.add_campaign("2024-01-15", 1);
  m.judge("X", "A", {9, 5});
  lab.machines.push_back(m);
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].campaign, "S-42-1");
  lab.machines[0].stored().results[1].state = "as-left";
  EXPECT_TRUE(lab.lines().empty());
  // Whatever the campaigns are called.
  lab.machines[0].stored().results[1].state = "as-found";
  lab.machines[0].stored().results[0].state = "as-left";
  EXPECT_EQ(lab.lines().size(), 1U);
  lab.machines[0].stored().results[0].value = 5.0;
  lab.machines[0].stored().results[0].decision = "conforms";
  lab.machines[0].stored().results[1].value = 9.0;
  lab.machines[0].stored().results[1].decision = "does not conform";
  EXPECT_TRUE(lab.lines().empty());
}

MadeMachine worn() {
  MadeMachine m("S-45");
  m.follow("X", "B_mean", {-0.9, -1.9, -2.7, -3.7, -4.5, -5.5, -6.3, -7.2}, 0.1);
  m.judge("X", "B", {1, 2, 2.8, 3.8, 4.6, 5.6, 6.4, 7.3});
  return m;
}

TEST(WorklistLines, SoonIsTheLastValueWithItsForecast) {
  Laboratory lab;
  lab.machines.push_back(worn());
  lab.last_run.date = "2023-07-20", lab.due = "2024-03-01";
  auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].finding.id, "worklist.soon");
  EXPECT_NEAR(*lines[0].value, 7.3e-6, 1e-12);
  EXPECT_NEAR(*lines[0].u, 0.25e-6, 1e-12);
  EXPECT_EQ(text_of(lines[0], "date"), "2024-03-01");
  EXPECT_GT(text_of(lines[0], "leaves"), lab.last_run.date);
  // Its day has passed.
  lab.last_run.date = "2024-06-01";
  lines = lab.lines();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].finding.id, "worklist.soon-now");
  EXPECT_EQ(lines[0].id, "worklist.soon:S-45:X:B");
  EXPECT_EQ(text_of(lines[0], "leaves"), "");
  EXPECT_EQ(lines[1].kind, Kind::overdue);
  // The value is indeterminate: that line asks for more.
  auto& last = lab.machines[0].stored().results.back();
  last.value = 7.6, last.decision = "cannot be decided";
  for (const WorkItem& l : lab.lines()) EXPECT_NE(l.kind, Kind::soon);
  // The last value was measured without a limit: the forecast follows it, and so does the line.
  last.value = 7.3, last.tolerance.reset(), last.decision.clear();
  lines = lab.lines();
  ASSERT_EQ(lines[0].kind, Kind::soon);
  EXPECT_NEAR(*lines[0].value, 7.3e-6, 1e-12);
  EXPECT_EQ(lines[0].campaign, lab.machines[0].stored().campaigns.back().id);
}

TEST(WorklistLines, ManyOfOneKindAreOneLine) {
  Laboratory lab;
  for (int i = 0; i < 212; ++i) {
    const std::string id = "c" + std::to_string(i);
    lab.last_run.vanished.push_back({id, "site-b/" + id, 4, "not there"});
    lab.machine_of_campaign[id] = "S-" + std::to_string(i % 20);
  }
  for (int i = 0; i < 9; ++i)
    lab.last_run.failed.push_back({"f" + std::to_string(i), "f", "site.toml:3: wrong", ""});
  for (int i = 0; i < 6; ++i) {
    lab.machines.emplace_back("S-1" + std::to_string(i));
    lab.machines.back().judge("X", "B", {8, 8, 8, 8, 8, 8, 8, 8});
  }
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 8U);
  EXPECT_EQ(lines[0].finding.id, "worklist.lost-several");
  EXPECT_EQ(text_of(lines[0], "of"), "site-b");
  EXPECT_EQ(lines[0].campaigns.size(), 212U);
  EXPECT_EQ(lines[1].finding.id, "worklist.failed-several");
  EXPECT_EQ(lines[1].campaigns.size(), 9U);
  for (std::size_t i = 2; i < lines.size(); ++i)  // each value has a line
    EXPECT_EQ(lines[i].finding.id, "worklist.undecided");
}

std::vector<std::string> open_of(const WorkItem& l) {
  std::vector<std::string> out{l.quantity};
  for (const reports::OpenValue& v : l.also)
    out.push_back(v.quantity + (v.value ? v.undecided ? "?" : "" : " without value"));
  return out;
}

TEST(WorklistLines, ListAllThatIsOpenOfAnAxis) {
  Laboratory lab;
  MadeMachine m("S-42", 2);
  m.judge("X", "A", {9, 9});
  m.judge("X", "B", {9, 12});
  m.judge("X", "E", {9, 8});  // indeterminate
  m.judge("X", "R", {9, 5});  // a newer measurement replaced it
  m.stored().without_value = {{1, "", "X", "M", "um", 5.0}, {1, "", "Y", "A", "um", 5.0}};
  lab.machines.push_back(m);
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);  // Y was not measured
  EXPECT_EQ(open_of(lines[0]), (std::vector<std::string>{"B", "A", "E?", "M without value"}));
  EXPECT_NEAR(*lines[0].also[0].value, 9e-6, 1e-12);
  EXPECT_NEAR(lines[0].also[0].limit, 8e-6, 1e-12);
  EXPECT_EQ(lines[0].also[0].campaign, "S-42-2");
}

TEST(WorklistLines, ALaterCircleOfAnotherPlaneReplacesNone) {
  Laboratory lab;
  MadeMachine m("S-42", 2);
  m.judge("", "G", {9}, "circle");
  m.judge("", "G", {5, 5}, "circle");
  auto& results = m.stored().results;
  results[0].measurement = "XY";
  results.erase(results.begin() + 1);
  results[1].measurement = "YZ";
  lab.machines.push_back(m);
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].kind, Kind::out);
  EXPECT_EQ(lines[0].measurement, "XY");
}

TEST(WorklistLines, ACampaignWithoutAMachineHasItsLines) {
  Laboratory lab;
  MadeMachine m("", 1);
  m.judge("X", "B", {9});
  lab.machines.push_back(m);
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].kind, Kind::out);
  EXPECT_EQ(lines[0].campaign, "-1");
  EXPECT_TRUE(lines[0].machine.empty());
  EXPECT_EQ(lines[1].finding.id, "worklist.no-machine");
  EXPECT_EQ(lines[1].campaigns, std::vector<std::string>{"-1"});
}

TEST(WorklistLines, WhatWasWithheldIsALine) {
  Laboratory lab;
  MadeMachine m("S-42", 3);
  for (const char* axis : {"X", "Y"}) m.follow(axis, "scale", {1, 1}, 0.1);
  m.follow("X", "scale", {}, 0.1);
  m.stored().results.push_back(m.stored().results[0]);  // X once more, in the last campaign
  m.stored().results.back().campaign = 2;
  m.stored().asked.resize(3);
  for (const char* axis : {"X", "Y"})
    m.stored().asked[1].push_back({axis, "fanuc", "table.refused-reversal", "attention"});
  m.stored().asked[0] = {{"", "certificate", "certificate.incomplete", "attention"}};
  for (const std::size_t campaign : {0, 1})  // the first was measured again
    m.stored().asked[campaign].push_back(
        {"", "plausibility", "traceability.calibration-expired", "attention"});
  for (const std::size_t campaign : {0, 1})
    m.stored().asked[campaign].push_back(
        {"D1", "diagonal-straightness", "diagonals.refused-carrier", "attention"});
  lab.machines.push_back(m);
  std::vector<std::string> ids;
  for (const WorkItem& l : lab.lines())
    if (l.kind == Kind::withheld) ids.push_back(l.id);
  EXPECT_EQ(ids, (std::vector<std::string>{
                     "worklist.calibration:S-42:S-42-2", "worklist.certificate:S-42:S-42-1",
                     "worklist.no-result:S-42:S-42-2", "worklist.no-table:S-42:S-42-2:Y"}));
}

TEST(WorklistLines, AnAcknowledgementCoversWhatWasOpenOnItsDay) {
  Laboratory lab;
  MadeMachine m("S-42", 2);  // 2020-01-15, 2020-07-15
  m.judge("X", "B", {9, 9});
  m.judge("X", "A", {9, 9});
  m.judge("X", "R", {5, 9});  // came later
  lab.machines.push_back(m);
  lab.logs.acknowledged = {acknowledged("worklist.out:S-42:X", "2020-03-01")};
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].state, State::fresh);
  EXPECT_EQ(open_of(lines[0]), std::vector<std::string>{"R"});
  EXPECT_EQ(lines[1].state, State::known);
  EXPECT_EQ(open_of(lines[1]), (std::vector<std::string>{"A", "B"}));
}

TEST(WorklistLines, TheCampaignsOfAMachineThatVanishedAreOneLine) {
  Laboratory lab;
  for (const char* id : {"a", "b"}) {
    lab.last_run.vanished.push_back({id, id, 4, "not there"});
    lab.machine_of_campaign[id] = "S-1";
  }
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].machine, "S-1");
}

Templates words_of(const std::string& language) {
  Templates out;
  const std::string path = std::string(NONIO_WORDS) + "/" + language + "/site.toml";
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  auto settings = config::parse_settings(text.str(), path);
  if (settings) out.tables["words/" + language + "/site"] = std::move(*settings);
  return out;
}

TEST(WorklistLines, EachHasWordsInEachLanguage) {
  Laboratory lab;
  lab.last_run.vanished = {{"gone", "gone", 4, "not there"}, {"a", "a", 4, ""}, {"b", "b", 4, ""}};
  lab.machine_of_campaign = {{"a", "S-1"}, {"b", "S-1"}};
  lab.last_run.failed = {{"bad", "bad", "wrong", ""}};
  lab.last_run.history_error = "disk full";
  lab.spellings = {{"S-42", "S-4Z", "spelled alike"}};
  lab.unknown = {"S-4Z (events.toml:7)"};
  lab.machines = {hit(), MadeMachine("S-43"), MadeMachine("S-44"), MadeMachine("S-45"),
                  MadeMachine("S-46")};
  lab.machines[1].follow("X", "B_mean", flat(-1.0, -3.0), 0.1);
  lab.machines[1].follow("Y", "squareness:XY.c", flat(-1.0, -3.0), 0.1);
  lab.machines[1].events() = {{"2022-03-01", "S-43", "Y", "moved", "hall 2", "", 1}};
  lab.machines[2].judge("X", "B", {7, 7, 7, 7, 7, 7, 7, 7.9});
  lab.machines[3].follow("X", "B_mean", {-1, -1.9, -3.1, -4, -5.1, -6, -7, -7.9}, 0.1);
  lab.machines[3].judge("X", "B", {1, 2, 3, 4, 5, 6, 7, 7.4});
  lab.machines[4].judge("X", "B", {5, 5, 5, 5, 5, 5, 5, 5});
  lab.machines[4].judge("Y", "B", {5, 5, 5, 5, 5, 5, 9, 5});
  lab.machines[4].stored().campaigns[7].run = 5;
  lab.machines[4].stored().findings.back() = {{"reading.suspect", "attention"},
                                              {"reversal.lost-motion", "attention"}};
  lab.machines.emplace_back("S-47", 1);
  lab.machines[5].judge("X", "B", {5});
  lab.machines[5].stored().later = {{"S-47-2", "2042-03-01"}};
  lab.machines.emplace_back("", 1);
  lab.machines[6].judge("X", "B", {5});
  lab.machines[6].stored().without_value = {{0, "", "X", "A", "um", 5.0}};
  lab.machines[6].stored().asked = {{{"X", "fanuc", "table.refused-reversal", "attention"},
                                     {"", "certificate", "certificate.incomplete", "attention"}}};
  lab.machines.emplace_back("S-49", 1);
  lab.machines[7].judge("X", "B", {5});
  lab.machines[7].stored().asked = {
      {{"", "plausibility", "traceability.calibration-expired", "attention"},
       {"D1", "diagonal-straightness", "diagonals.refused-place", "attention"}}};
  lab.machines.emplace_back("S-48", 1);
  lab.machines[8].judge("X", "B", {8});
  lab.machines[8].stored().results.back().expanded.reset();
  lab.last_run.waiting = {"S-48-1"};
  for (int i = 0; i < 4; ++i)
    lab.last_run.failed.push_back({"f" + std::to_string(i), "f", "same", ""});
  lab.due = "2024-03-01";
  const auto lines = lab.lines();
  std::set<std::string> ids;
  for (const char* language : {"en", "de", "it"}) {
    const Templates words = words_of(language);
    ASSERT_FALSE(words.tables.empty()) << language;
    for (const WorkItem& l : lines) {
      ids.insert(l.finding.id);
      const std::string says = reports::line_text(words, language, l, "says");
      EXPECT_FALSE(says.empty()) << l.finding.id;
      EXPECT_EQ(says.find('{'), std::string::npos) << language << ": " << says;
      if (l.state == State::fixed) continue;
      const std::string advice = reports::line_text(words, language, l, "advice");
      EXPECT_FALSE(advice.empty()) << l.finding.id;
      EXPECT_EQ(advice.find('{'), std::string::npos) << language << ": " << advice;
    }
  }
  for (const char* id : {"worklist.lost",           "worklist.lost-several",
                         "worklist.failed",         "worklist.history",
                         "worklist.out-changed",    "worklist.changed",
                         "worklist.changed-event",  "worklist.soon-now",
                         "worklist.overdue",        "worklist.undecided",
                         "worklist.fixed",          "worklist.conforms",
                         "worklist.not-judged",     "worklist.spelling",
                         "worklist.later",          "worklist.unknown-machine",
                         "worklist.no-machine",     "worklist.no-value",
                         "worklist.no-table",       "worklist.certificate",
                         "worklist.no-uncertainty", "worklist.draft",
                         "worklist.failed-several", "worklist.calibration",
                         "worklist.no-result",      "worklist.misreading"})
    EXPECT_TRUE(ids.contains(id)) << id;
}

}  // namespace
}  // namespace nonio::test::lines_test
