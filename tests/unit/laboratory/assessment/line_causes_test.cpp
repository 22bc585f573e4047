// SPDX-License-Identifier: Apache-2.0
//
// Which change and which event the worklist names as the cause, and what it forecasts.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "batch/close/mail.h"
#include "made_laboratory.h"

namespace nonio::test::lines_test {
namespace {

TEST(WorklistLines, OneCauseIsReportedOnce) {
  Laboratory lab;
  lab.machines.push_back(hit());
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);  // B and R out, reversal and curve changed: one crash
  const WorkItem& l = lines[0];
  EXPECT_EQ(l.kind, Kind::out);
  EXPECT_EQ(l.state, State::fresh);
  EXPECT_EQ(l.id, "worklist.out:S-42:X");
  EXPECT_EQ(l.machine + " " + l.axis + " " + l.quantity, "S-42 X B");
  EXPECT_EQ(l.finding.id, "worklist.out-changed");
  EXPECT_EQ(l.since, "2022-07-15");
  EXPECT_EQ(text_of(l, "after"), "2022-01-15");
  EXPECT_EQ(text_of(l, "before"), "2022-07-15");
  EXPECT_EQ(text_of(l, "look"), "reversal");
  EXPECT_NEAR(*l.value, 10.0e-6, 0.2e-6);
  EXPECT_NEAR(*l.u, 0.25e-6, 1e-9);
  EXPECT_NEAR(*l.limit, 8e-6, 1e-12);
}

TEST(WorklistLines, WhatHasNoAxisIsOneLineForEachAnalysis) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("", "G_ccw", flat(9.0, 9.0), "circle");
  m.judge("", "G_cw", flat(10.0, 10.0), "circle");
  m.judge("", "sync_X", flat(9.5, 9.5), "spindle");
  lab.machines.push_back(std::move(m));
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].id + " " + lines[0].quantity, "worklist.out:S-42:circle G_cw");
  EXPECT_EQ(lines[1].id + " " + lines[1].quantity, "worklist.out:S-42:spindle sync_X");
  EXPECT_EQ(lines[0].axis + lines[1].axis, "");
}

/// Findings of a machine with these reversals and judged values of X.
std::vector<std::string> findings_of(const std::vector<double>& reversals, const char* judged,
                                     const std::vector<double>& values) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.follow("X", "B_mean", reversals, 0.1);
  m.judge("X", judged, values);
  lab.machines.push_back(std::move(m));
  std::vector<std::string> out;
  for (const WorkItem& line : lab.lines()) out.push_back(line.finding.id);
  return out;
}

TEST(WorklistLines, AStepThatWasUndoneIsNotACause) {
  EXPECT_EQ(findings_of({-4.0, -3.9, -4.1, -9.0, -9.1, -4.0, -3.9, -4.1}, "R", flat(6.0, 10.0)),
            std::vector<std::string>{"worklist.out"});
}

TEST(WorklistLines, AnImprovementIsNotDamage) {
  for (const double last : {-0.9, 0.5})
    EXPECT_EQ(findings_of(flat(-6.0, last), "B", flat(6.0, 6.0)),
              std::vector<std::string>{"worklist.changed-better"});
}

TEST(WorklistLines, WhatConformsAndChangedIsAChange) {
  Laboratory lab;
  lab.machines.push_back(hit(6.0, -5.5));
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].kind, Kind::changed);
  EXPECT_EQ(lines[0].id, "worklist.changed:S-42:X:2022-07-15");
  EXPECT_EQ(text_of(lines[0], "also"), "curve_2");
}

TEST(WorklistLines, AChangeThatIsNotSureIsNotMailed) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.follow("X", "B_mean", flat(-4.0, -4.35), 0.1);
  m.judge("X", "B", flat(6.0, 6.0));
  lab.machines.push_back(std::move(m));
  ASSERT_EQ(lab.lines().size(), 1U);
  ASSERT_EQ(lab.lines()[0].kind, Kind::changed);
  const auto evidence = lab.lines()[0].finding.evidence;
  const auto p =
      std::find_if(evidence.begin(), evidence.end(), [](const Number& n) { return n.name == "p"; });
  ASSERT_NE(p, evidence.end());
  for (const double level : {0.008, 0.03}) {
    lab.asked = {{1, static_cast<std::uint64_t>(level / p->value)}};
    const auto lines = lab.lines();
    ASSERT_EQ(lines.size(), 1U) << level;
    EXPECT_TRUE(reports::asks(lines[0]));
    EXPECT_EQ(reports::asks_by_mail(lines[0]), level < 0.01);
    for (const auto on : {config::Mail::On::lost, config::Mail::On::out})
      EXPECT_FALSE(batch::is_reason_for_mail(lines[0], on));
    EXPECT_EQ(batch::is_reason_for_mail(lines[0], config::Mail::On::decision), level < 0.01);
  }
  WorkItem lost = assessment::line_of(Kind::lost, "worklist.lost", "c");
  EXPECT_TRUE(batch::is_reason_for_mail(lost, config::Mail::On::lost));
}

TEST(WorklistLines, OutNamesTheEventOfItsChange) {
  Laboratory lab;
  lab.machines.push_back(hit());
  lab.machines[0].events() = {{"2022-03-01", "S-42", "X", "crash", "hit the vice", "", 1}};
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].finding.id, "worklist.out-changed-event");
  EXPECT_EQ(text_of(lines[0], "event"), "crash: hit the vice");
}

TEST(WorklistLines, ARepairEndsAChange) {
  Laboratory lab;
  lab.machines.push_back(hit(6.0, -5.5));
  const auto repaired = [&](const char* day) {
    lab.machines[0].events() = {{day, "S-42", "X", "repair", "new nut", "", 1}};
    return lab.lines().empty();
  };
  EXPECT_TRUE(repaired("2023-09-01"));
  EXPECT_FALSE(repaired("2022-09-01")) << "a later campaign shows that it did not help";
}

TEST(WorklistLines, ALimitThatIsExceededWithoutAChangeSaysNoChange) {
  Laboratory lab;
  MadeMachine m("S-42");
  m.judge("X", "A", {8.6, 8.7, 8.8, 8.9, 9.0, 9.1, 9.2, 9.3});
  lab.machines.push_back(std::move(m));
  const auto lines = lab.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].finding.id, "worklist.out");
  EXPECT_EQ(lines[0].since, "2020-01-15");
}

const reports::HistorySeries& series_of(const reports::MachineHistory& m, const char* quantity) {
  return *std::find_if(m.series.begin(), m.series.end(),
                       [&](const auto& s) { return s.quantity == quantity; });
}

TEST(Forecasts, AreOfTheQuantityThatHasTheLimit) {
  MadeMachine m("S-42");
  m.follow("X", "B_mean", flat(-7.0, -7.0), 0.05);
  m.judge("X", "B", flat(7.4, 7.4));  // limit 8
  std::vector<assessment::AssessedMachine> one{m.assessed()};
  judge_all(one);
  const auto d = assessment::describe(one[0], "out", "2024-03-01", "12 months");
  const auto &mean = series_of(d, "B_mean"), &B = series_of(d, "B");
  ASSERT_TRUE(mean.forecast && B.forecast);
  EXPECT_FALSE(mean.limit);
  EXPECT_NEAR(*B.limit, 8e-6, 1e-12);
  EXPECT_NEAR(B.forecast->value, 7.4e-6, 0.1e-6);
  // |B_mean| of 7 um is never beyond 8 um, B at times.
  EXPECT_GT(B.forecast->p_out, 1e-6);
  EXPECT_EQ(B.forecast->answer, "keep");
  EXPECT_EQ(mean.forecast->answer, "expected") << "it has no limit of its own";
}

TEST(Forecasts, AFollowedQuantityWithItsOwnLimitKeepsTheDate) {
  MadeMachine m("S-42");
  m.follow("X", "B_mean", flat(-3.0, -3.0), 0.05);
  m.judge("X", "B_mean", flat(3.0, 3.0));  // limit 8
  std::vector<assessment::AssessedMachine> one{m.assessed()};
  judge_all(one);
  const auto d = assessment::describe(one[0], "out", "2024-03-01", "12 months");
  ASSERT_TRUE(series_of(d, "B_mean").forecast);
  EXPECT_EQ(series_of(d, "B_mean").forecast->answer, "keep");
}

TEST(Forecasts, NothingKeepsTheDateOfAnAxisThatIsOut) {
  MadeMachine m("S-42");
  m.follow("X", "B_mean", flat(-3.0, -3.0), 0.05);
  m.follow("X", "scale", flat(1.0, 1.0), 0.05);
  m.follow("Y", "scale", flat(1.0, 1.0), 0.05);
  m.judge("X", "B", flat(4.0, 4.0));
  m.judge("X", "R", flat(9.5, 9.5));  // out
  std::vector<assessment::AssessedMachine> one{m.assessed()};
  judge_all(one);
  const auto d = assessment::describe(one[0], "out", "2024-03-01", "12 months");
  for (const auto& s : d.series)
    if (s.forecast) EXPECT_EQ(s.forecast->answer, s.axis == "X" ? "act" : "expected") << s.quantity;
}

TEST(Forecasts, AskForAMeasurementNowWhereTheLimitMayBeExceededNow) {
  MadeMachine m("S-45");
  m.follow("X", "B_mean", {-0.9, -1.8, -2.5, -3.4, -4.1, -5.0, -5.7, -6.5}, 0.3);
  m.judge("X", "B", {1, 1.9, 2.6, 3.5, 4.2, 5.1, 5.8, 6.8});
  std::vector<assessment::AssessedMachine> one{m.assessed()};
  judge_all(one);
  const auto forecast = [&](const std::string& today) {
    return *series_of(assessment::describe(one[0], "out", "2024-03-01", "", today), "B").forecast;
  };
  const auto early = forecast("2023-07-20");
  EXPECT_EQ(early.answer, "watch") << early.p_out;
  ASSERT_LT(early.leaves, "2024-03-01");
  EXPECT_EQ(forecast(early.leaves).answer, "watch-now");
}

// The worklist has no line for a usual interval that has passed, so the page requires no action.
TEST(Forecasts, OnlyAStatedDateObliges) {
  MadeMachine steady("S-46"), drifting("S-47");
  for (MadeMachine* m : {&steady, &drifting}) {
    const bool drifts = m == &drifting;
    const std::vector mean{-0.3, -1.2, -2.2, -3.1, -4.0, -5.0, -5.9, -6.8},
        B{0.5, 1.4, 2.3, 3.3, 4.2, 5.2, 6.1, 7.0};
    m->follow("X", "B_mean", drifts ? mean : flat(-2.0, -2.0), 0.3);
    m->judge("X", "B", drifts ? B : flat(2.1, 2.1));
  }
  std::vector<assessment::AssessedMachine> both{steady.assessed(), drifting.assessed()};
  judge_all(both);
  const auto answer = [&](std::size_t machine, const std::string& due) {
    return series_of(assessment::describe(both[machine], "out", due, "", "2040-01-01"), "B")
        .forecast->answer;
  };
  EXPECT_EQ(answer(0, ""), "passed");
  EXPECT_EQ(answer(1, ""), "watch-now");
  EXPECT_EQ(answer(0, "2024-03-01"), "overdue");
}

TEST(Forecasts, NothingKeepsTheDateOfAnAxisThatIsOpenOrOverdue) {
  MadeMachine m("S-42");
  m.follow("X", "scale", flat(1.0, 1.0), 0.05);
  m.follow("Y", "scale", flat(1.0, 1.0), 0.05);
  m.judge("X", "R", flat(8.0, 8.0));  // indeterminate
  std::vector<assessment::AssessedMachine> one{m.assessed()};
  judge_all(one);
  for (const std::string today : {"2024-03-01", "2024-03-02"})
    for (const auto& s : assessment::describe(one[0], "out", "2024-03-01", "", today).series)
      if (s.forecast)
        EXPECT_EQ(s.forecast->answer, s.axis == "X"           ? "act"
                                      : today == "2024-03-01" ? "expected"
                                                              : "overdue");
}

TEST(Forecasts, AValueHasTheUOfItsCampaign) {
  MadeMachine m("S-42", 1);
  m.follow("X", "B_mean", {-4.0}, 0.1);
  for (const double U : {0.4, 0.05}) {
    MadeMachine own = m;
    store::StoredResult r = own.stored().results[0];
    r.followed = false, r.source = "iso230-2", r.u_repeat.reset(), r.expanded = U, r.k = 2.0;
    own.stored().results.push_back(r);
    const auto d = assessment::describe(own.assessed(), "out", "", "");
    ASSERT_EQ(d.series.size(), 1U);  // no second series under the same name
    EXPECT_NEAR(d.series[0].points[0].u, 0.1e-6, 1e-12);
    EXPECT_NEAR(2.0 * reports::u_of_value(d.series[0].points[0]), U * 1e-6, 1e-12);
  }
}

}  // namespace
}  // namespace nonio::test::lines_test
