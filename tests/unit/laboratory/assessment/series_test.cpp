// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/series.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "made.h"

namespace nonio::test::series_test {
namespace {

using Kind = nonio::statistics::Declared::Kind;

const std::vector<double> eight{1.0, 1.1, 0.9, 1.0, 1.05, 0.95, 1.0, 1.02};

TEST(WorklistSeries, SpansThatAreAlikeAreOne) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  for (std::size_t i = 4; i < 8; ++i)
    m.stored().results[i].conditions = R"({"from":5.0,"to":795.0})";  // within 1 %
  const auto series = m.series();
  ASSERT_EQ(series.size(), 1U);
  EXPECT_EQ(series[0].results.size(), 8U);
  EXPECT_TRUE(series[0].apart.empty());
}

TEST(WorklistSeries, AnotherSpanBeginsASeriesThatSaysWhy) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  for (std::size_t i = 5; i < 8; ++i)
    m.stored().results[i].conditions = R"({"from":0.0,"to":640.0})";
  const auto series = m.series();
  ASSERT_EQ(series.size(), 2U);
  EXPECT_EQ(series[0].results.size(), 5U);
  EXPECT_TRUE(series[0].ended);
  EXPECT_TRUE(series[0].apart.empty());
  EXPECT_EQ(series[1].results.size(), 3U);
  EXPECT_FALSE(series[1].ended);
  ASSERT_EQ(series[1].apart.size(), 5U);
  EXPECT_EQ(series[1].apart[0].why, "span");
}

TEST(WorklistSeries, OtherPlacesAndModelsAreOthers) {
  MadeMachine m("S-1", 4);
  m.follow("X", "scale", {1, 1, 1, 1}, 0.1, R"({"from":0.0,"to":800.0,"at":"Y=100"})");
  m.follow("X", "scale", {2, 2, 2, 2}, 0.1, R"({"from":0.0,"to":800.0,"at":"Y=500"})");
  m.follow("", "backlash:X.b", {1, 1}, 0.1, R"({"model":"backlash:X"})");
  m.follow("X2", "scale", {1, 1, 1, 1}, 0.1);
  const auto series = m.series();
  ASSERT_EQ(series.size(), 4U);
  EXPECT_EQ(std::count_if(series.begin(), series.end(), [](const auto& s) { return s.ended; }), 0);
}

TEST(WorklistSeries, LargestValuesOfCirclesHaveNoLineAndTheWorstOfADayCounts) {
  MadeMachine m("S-1");
  for (const char* of_path : {"G_ccw", "G_cw", "G_b", "H", "D", "F_max", "F_min"})
    m.judge("XY", of_path, eight, "circle");
  m.follow("X", "cyclic_circle_cos", eight, 0.1, R"({"radius":150.0,"period":10.0})");
  m.stored().results.back().conditions = R"({"radius":150.0,"period":5.0})";
  const auto series = m.series();
  ASSERT_EQ(series.size(), 2U);  // another pitch begins another
  for (const auto& s : series) EXPECT_EQ(s.quantity, "cyclic_circle_cos");
  auto again = m.stored().results.front();  // G_ccw of the first campaign, measured twice
  again.value = 20.0, again.decision = "does not conform";
  m.stored().results.push_back(again);
  const auto shown = assessment::shown_series(m.stored(), {});
  ASSERT_EQ(shown.size(), 7U);
  for (const auto& s : shown) {
    EXPECT_EQ(s.judged.size(), 8U) << s.quantity;
    EXPECT_EQ(m.stored().results[s.judged.front()].value,
              s.quantity == "G_ccw" ? 20.0 : eight.front());
  }
}

TEST(WorklistSeries, CirclesAreSeparateFromDiagonalsAndComparedWithTheirLike) {
  MadeMachine m("S-1");
  m.follow("XY", "squareness:XY", {1, 1, 1}, 0.1, "{}");
  m.follow("XY", "squareness:XY.circle", eight, 0.1,
           R"({"radius":150.0,"feed":1000.0,"at":"X=400 Y=250"})");
  auto& results = m.stored().results;
  for (std::size_t i = 7; i < 9; ++i)
    results[i].conditions = R"({"radius":100.0,"feed":1000.0,"at":"X=400 Y=250"})";
  for (std::size_t i = 9; i < 11; ++i)
    results[i].conditions = R"({"radius":100.0,"feed":5000.0,"at":"X=400 Y=250"})";
  const auto series = m.series();
  ASSERT_EQ(series.size(), 4U);
  EXPECT_EQ(series[0].quantity, "squareness:XY");
  EXPECT_FALSE(series[0].ended);  // circles do not end what diagonals began
  EXPECT_TRUE(series[0].apart.empty());
  EXPECT_EQ(series[1].results.size(), 4U);
  EXPECT_TRUE(series[1].ended);
  ASSERT_EQ(series[2].apart.size(), 4U);
  EXPECT_EQ(series[2].apart[0].why, "radius");
  ASSERT_EQ(series[3].apart.size(), 6U);
  EXPECT_EQ(series[3].apart.back().why, "feed");
  // An event of an axis concerns what its circles say.
  m.events() = {{"2020-09-01", "S-1", "Y", "crash", "vice", "", 1}};
  EXPECT_EQ(m.series()[1].kinds, std::vector<std::string>{"crash"});
}

TEST(WorklistSeries, AnEventOfAGantryAxisConcernsItsSides) {
  for (const auto& [axis, is_known] :
       {std::pair{"X", true}, {"X1", true}, {"X2", false}, {"Y", false}}) {
    MadeMachine m("S-1");
    m.follow("X1", "scale", eight, 0.1);
    m.events() = {{"2020-09-01", "S-1", axis, "crash", "vice", "", 1}};
    EXPECT_EQ(m.series()[0].kinds.size(), is_known ? 1U : 0U) << axis;
  }
}

TEST(WorklistSeries, ATableIsAStepThatIsKnown) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  auto& results = m.stored().results;
  results[3].state = "as-left";
  for (std::size_t i = 6; i < 8; ++i)
    results[i].conditions = R"({"from":0.0,"to":800.0,"compensation":"on"})";
  results[5].conditions = R"({"from":0.0,"to":800.0,"compensation":"off"})";
  // Of the day of the adjustment: the same thing.
  m.events() = {{MadeMachine::day(3), "S-1", "X", "compensation", "table", "", 1}};
  const auto series = m.series();
  ASSERT_EQ(series.size(), 1U);
  ASSERT_EQ(series[0].series.declared.size(), 2U);
  EXPECT_EQ(series[0].series.declared[0].after, 2U);
  EXPECT_EQ(series[0].series.declared[1].after, 5U);
  EXPECT_EQ(series[0].series.declared[1].kind, Kind::table);
}

TEST(WorklistSeries, WhatChangesWithinACampaignIsItsOwnWork) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  auto& results = m.stored().results;
  results[4].campaign = results[3].campaign;  // states "start" and "end": in the manifest's order
  results[3].measurement = "X start", results[4].measurement = "X end";
  const auto series = m.series();
  ASSERT_EQ(series.size(), 1U);
  ASSERT_EQ(series[0].results.size(), 8U);
  EXPECT_EQ(series[0].results[3], 3U);
  EXPECT_EQ(series[0].results[4], 4U);
  ASSERT_EQ(series[0].series.declared.size(), 1U);
  EXPECT_EQ(series[0].series.declared[0].after, 3U);
  EXPECT_EQ(series[0].series.declared[0].kind, Kind::table);
}

TEST(WorklistSeries, EventsAreBetweenTheirCampaigns) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  m.follow("Y", "scale", eight, 0.1);
  m.events() = {{"2021-03-01", "S-1", "X", "crash", "vice", "", 1},
                {"2022-03-01", "S-1", "", "moved", "hall 2", "", 2},
                {"2030-01-01", "S-1", "X", "crash", "later", "", 3}};
  const auto series = m.series();
  ASSERT_EQ(series.size(), 2U);
  ASSERT_EQ(series[0].series.declared.size(), 2U);
  EXPECT_EQ(series[0].series.declared[0].after, 2U);
  EXPECT_EQ(series[0].kinds[0], "crash");
  EXPECT_EQ(series[0].said[0], "vice");
  ASSERT_EQ(series[1].series.declared.size(), 1U);
  EXPECT_EQ(series[1].kinds[0], "moved");
}

TEST(WorklistSeries, AnotherInstrumentIsKnown) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  for (std::size_t i = 0; i < 8; ++i)
    m.stored().results[i].common = {{i < 5 ? "instrument L-1 C-1" : "instrument L-1 C-2", 0.3}};
  const auto series = m.series();
  ASSERT_EQ(series[0].series.declared.size(), 1U);
  EXPECT_EQ(series[0].series.declared[0].after, 4U);
  EXPECT_EQ(series[0].series.declared[0].kind, Kind::instrument);
}

TEST(WorklistSeries, TheOrderOfRowsIsNone) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  const auto first = m.series();
  std::reverse(m.stored().results.begin(), m.stored().results.end());
  const auto second = m.series();
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(first[0].series.seed, second[0].series.seed);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(first[0].series.points[i].value, second[0].series.points[i].value);
}

TEST(WorklistSeries, WhatIsNotSureIsNoPoint) {
  MadeMachine m("S-1");
  m.follow("X", "scale", eight, 0.1);
  m.stored().results[2].u_repeat.reset();
  m.stored().results[3].u_repeat = 0.0;
  m.stored().campaigns[4].day = "";
  EXPECT_EQ(m.series()[0].results.size(), 5U);
}

TEST(WorklistSeries, AnEventMayNameTheSerialNumberOfOneMachine) {
  const auto state = [](const char* name, const char* serial) {
    return store::MachineState{{name, {"", "M", "V", serial}, 1}, 1, {serial}};
  };
  store::StoredLogs logs;
  logs.events = {{"2021-03-01", "417", "X", "crash", "vice", "", 1},
                 {"2021-03-02", "old", "X", "crash", "vice", "", 1}};
  logs.aliases = {{"old", "M 417"}};
  std::vector<store::MachineState> all{state("M 417", "417"), state("M 418", "418")};
  const auto count = [&](const char* machine) {
    return assessment::MachineEvents(all, logs).of(machine).size();
  };
  EXPECT_EQ(count("M 417"), 2U);
  EXPECT_EQ(count("M 418"), 0U);
  EXPECT_TRUE(assessment::MachineEvents(all, logs).of_none().empty());
  all[1].serials.insert("417");  // now it may be either
  EXPECT_EQ(count("M 417"), 1U);
  EXPECT_EQ(count("M 418"), 0U);
  EXPECT_EQ(assessment::MachineEvents(all, logs).of_none().size(), 1U);
  all.push_back(state("417", "900"));  // the name of a machine is that machine's alone
  all[1].serials.erase("417");
  EXPECT_EQ(count("M 417"), 1U);
  EXPECT_EQ(count("417"), 1U);
}

}  // namespace
}  // namespace nonio::test::series_test
