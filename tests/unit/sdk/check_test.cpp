// SPDX-License-Identifier: Apache-2.0
// What every later stage relies on: each rule of sdk/check.h, broken once.
#include "nonio/sdk/check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "nonio/sdk/plugin.h"

using namespace nonio;

namespace {

const double nan = std::nan("");

Observations readings() {
  Observations o;
  o.axes = {{"X", false, {0.0, 0.1, 0.2}, {1, 1, -1}}};
  o.lines = {{"a", {1, 0, 0}}, {"b", {1, 0, 0}}};
  o.deviation = {1e-6, 2e-6, 3e-6};
  o.u = {1e-7, 1e-7, 2e-7};
  o.run = {1, 1, 2};
  o.line = {0, 0, 1};
  o.source_line = {2, 3, 4};
  o.time = {0.0, nan, 2.0};
  o.material = o.air = o.pressure = o.humidity = {20.0, nan, 20.0};
  o.sense = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  return o;
}

std::string found(const Observations& o) {
  const auto sound = check(o);
  return sound ? "" : sound.error().message;
}

TEST(Check, SoundReadingsPassWithBlanks) { EXPECT_EQ(found(readings()), ""); }

TEST(Check, EveryColumnMustHaveAnEntryForEachReading) {
  std::size_t columns = 0;
  Observations count = readings();
  for_each_column(count, [&](auto&) { ++columns; });
  EXPECT_EQ(columns, 13U);
  for (std::size_t k = 0; k < columns; ++k) {
    Observations o = readings();
    std::size_t at = 0;
    for_each_column(o, [&](auto& column) {
      if (at++ == k) column.push_back(column.back());
    });
    EXPECT_EQ(found(o), "columns of different lengths") << "column " << k;
  }
}

TEST(Check, WhatIsReadByIndexMustExist) {
  Observations o = readings();
  o.line[1] = 2;
  EXPECT_EQ(found(o), "reading 2 of line 2; expected 0 to 1");
  o = readings();
  o.lines.clear();
  EXPECT_EQ(found(o), "readings of no line; expected one line at least");
  o = {};
  EXPECT_EQ(found(o), "") << "no readings need no line";
}

TEST(Check, NumbersMustBeNumbers) {
  const std::vector<std::pair<std::string, std::function<void(Observations&)>>> wrong = {
      {"a deviation that is not a number", [](auto& o) { o.deviation[1] = nan; }},
      {"a position of X that is not a number", [](auto& o) { o.axes[0].position[0] = INFINITY; }},
      {"an approach that is none of +1, -1 and 0", [](auto& o) { o.axes[0].approach[2] = 2; }},
      {"an uncertainty of a reading that is not a number above 0", [](auto& o) { o.u[0] = 0.0; }},
      {"a direction of sensing that is not a number", [](auto& o) { o.sense[0][1] = nan; }},
      {"a direction of sensing that is not a number", [](auto& o) { o.lines[0].sense[2] = nan; }},
      {"the doubt mine; expected findings plausibility.* of attention",
       [](auto& o) { o.doubts.push_back({.id = "mine", .attention = true}); }}};
  for (const auto& [message, spoil] : wrong) {
    Observations o = readings();
    spoil(o);
    EXPECT_EQ(found(o), message);
  }
}

TEST(Check, ResultsMustBeNumbersOfOneLength) {
  const auto found_in = [](const std::function<void(Evaluation&)>& spoil) {
    Evaluation e;
    e.values = {{"A", 1e-6, Quantity::deviation}};
    e.findings = {{.id = "f", .evidence = {{"mean", 1.0}}}};
    e.points.columns = {{"target", Quantity::length, {0.0, 1.0}},
                        {"B", Quantity::deviation, {nan, 1.0}}};
    e.series = {{"EXX", "X", Quantity::length, Quantity::deviation, {0, 1}, {0, 0}, {}}};
    spoil(e);
    const auto sound = check(e);
    return sound ? std::string() : sound.error().message;
  };
  EXPECT_EQ(found_in([](Evaluation&) {}), "") << "NaN in a table: no value";
  EXPECT_EQ(found_in([](Evaluation& e) { e.values.push_back(e.values[0]); }),
            "two values with the name A");
  EXPECT_EQ(found_in([](Evaluation& e) { e.points.columns[1].name = "target"; }),
            "two columns with the name target");
  EXPECT_EQ(found_in([](Evaluation& e) { e.series.push_back(e.series[0]); }),
            "two series with the name EXX");
  EXPECT_EQ(found_in([](Evaluation& e) { e.values[0].value = nan; }),
            "a value A that is not a number");
  EXPECT_EQ(found_in([](Evaluation& e) { e.values[0].U = INFINITY; }),
            "a value A that is not a number");
  EXPECT_EQ(found_in([](Evaluation& e) { e.findings[0].evidence[0].value = nan; }),
            "evidence mean of finding f that is not a number");
  EXPECT_EQ(found_in([](Evaluation& e) { e.points.columns[1].values.pop_back(); }),
            "a table with columns of different lengths");
  EXPECT_EQ(found_in([](Evaluation& e) { e.series[0].U = {1.0}; }),
            "a series EXX with columns of different lengths");
  EXPECT_EQ(found_in([](Evaluation& e) {
              e.budget.emplace().contributions.resize(2);
              e.budget->results = {{"A", Quantity::deviation, {1.0}}};
            }),
            "a budget of A with other contributions than it lists");
}

TEST(Check, PredictionsMustBeNumbers) {
  OutputResult r;
  r.predictions = {{"X", "E", 1e-6, nan}};
  ASSERT_FALSE(check(r));
  EXPECT_EQ(check(r).error().message, "a prediction of E that is not a number");
}

TEST(Columns, RowsAreKeptAndArrangedInEveryColumn) {
  const Observations o = rearranged(readings(), {2, 0});
  EXPECT_EQ(o.deviation, (std::vector<double>{3e-6, 1e-6}));
  EXPECT_EQ(o.axes[0].approach, (std::vector<std::int8_t>{-1, 1}));
  EXPECT_EQ(o.line, (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(o.humidity.size(), 2U);
  EXPECT_EQ(found(o), "");
  Observations kept = readings();
  keep_rows(kept, {0, 0, 1});
  EXPECT_EQ(kept.source_line, (std::vector<std::uint32_t>{4}));
  EXPECT_EQ(kept.sense.size(), 1U);
  EXPECT_EQ(found(kept), "");
}

TEST(Columns, WhatOneTableLacksIsUnknownInItsRows) {
  Observations to = readings(), bare = readings();
  for_each_measured_column([](auto& column) { column.clear(); }, bare);
  append_measured(to, bare);
  EXPECT_EQ(to.size(), 6U);
  EXPECT_EQ(to.run, (std::vector<std::uint32_t>{1, 1, 2, 1, 1, 1}));
  EXPECT_EQ(to.source_line, (std::vector<std::uint32_t>{2, 3, 4, 0, 0, 0}));
  EXPECT_TRUE(std::isnan(to.pressure[5]));
  append_measured(bare, readings());
  EXPECT_EQ(bare.run, (std::vector<std::uint32_t>{1, 1, 1, 1, 1, 2}));
  EXPECT_TRUE(std::isnan(bare.u[0]));
  EXPECT_EQ(bare.u[3], 1e-7);
}

TEST(Abi, TheTagHasTheVersionOfTheSdk) {
  EXPECT_EQ(
      std::string(NONIO_ABI_TAG).rfind("nonio-sdk " + std::to_string(NONIO_SDK_VERSION) + "; ", 0),
      0U)
      << NONIO_ABI_TAG;
}

}  // namespace
