// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/site_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include "laboratory/assessment/describe.h"
#include "made.h"

namespace nonio::test::site_tables_test {
namespace {

class Fleet {
 public:
  void add(const MadeMachine& made, const std::string& model = "V") {
    const assessment::AssessedMachine m = made.assessed();
    machines_.push_back(assessment::describe(m, "/nowhere", "", ""));
    machines_.back().model = model;
    values_.push_back(assessment::compared_of(m, machines_.back()));
  }
  /// A machine with one campaign.
  void add(const std::string& name, double value, const std::string& conditions,
           const std::string& model = "V") {
    MadeMachine made(name, 1);
    made.follow("X", "B_mean", {value}, 0.2, conditions);
    add(made, model);
  }
  std::vector<reports::ModelComparison> compared() const {
    std::vector<assessment::ComparedMachine> all;
    for (std::size_t i = 0; i < machines_.size(); ++i) all.push_back({&machines_[i], &values_[i]});
    return assessment::comparisons_of(all);
  }

 private:
  std::deque<reports::MachineHistory> machines_;
  std::deque<std::vector<assessment::ComparedValue>> values_;
};

std::string over(double from, double to, const std::string& more = "") {
  return "{\"from\":" + std::to_string(from) + ",\"to\":" + std::to_string(to) + more + "}";
}

std::vector<std::string> names(const reports::ModelComparison& c) {
  std::vector<std::string> out;
  for (const auto& m : c.machines) out.push_back(m.machine);
  return out;
}

using Names = std::vector<std::string>;

TEST(Comparisons, TravelsOfOneLengthOnly) {
  Fleet fleet;
  fleet.add("a", 1.0, over(0, 500));
  fleet.add("b", 2.0, over(0, 1000));
  fleet.add("c", 3.0, over(0, 505));
  fleet.add("d", 4.0, over(20, 1080));
  fleet.add("e", 7.0, over(-549, 0));
  fleet.add("f", 6.0, over(5, 1005));
  fleet.add("g", 9.0, over(0, 1200));  // of this length there is one
  const auto all = fleet.compared();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(names(all[0]), (Names{"a", "c", "e"}));
  EXPECT_NEAR(all[0].travel->shortest, 0.5, 1e-12);
  EXPECT_NEAR(all[0].travel->longest, 0.549, 1e-12);
  EXPECT_EQ(names(all[1]), (Names{"b", "d", "f"}));
  EXPECT_NEAR(all[1].median, 4e-6, 1e-18);
  EXPECT_NEAR(all[1].spread, 1.4826 * 2e-6, 1e-18);
  EXPECT_NEAR(all[1].machines[0].z, -1 / 1.4826, 1e-12);
  EXPECT_EQ(all[1].count, 3U);
}

TEST(Comparisons, OnePlaceOnlyWhateverTheTable) {
  Fleet fleet;
  const auto at_y = [](int y, const char* more) {
    return over(0, 500, ",\"at\":\"Y=" + std::to_string(y) + "\"" + more);
  };
  for (const char* name : {"a", "b"}) fleet.add(name, 1.0, at_y(0, ",\"compensation\":\"on\""));
  for (const char* name : {"c", "d"}) fleet.add(name, 1.0, at_y(800, ""));
  fleet.add("e", 1.0, at_y(0, ",\"compensation\":\"off\""));
  fleet.add("other model", 1.0, at_y(0, ""), "W");
  fleet.add("no model", 1.0, at_y(0, ""), "");
  const auto all = fleet.compared();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(names(all[0]), (Names{"a", "b", "e"}));
}

TEST(Comparisons, TheLastValueThatWasFoundCounts) {
  Fleet fleet;
  for (const char* name : {"a", "b", "c"}) {
    MadeMachine made(name, 4);
    made.follow("X", "B_mean", {1.0, 2.0, 3.0, 4.0}, 0.2);
    made.stored().results[3].state = "as-left";
    fleet.add(made);
  }
  const auto all = fleet.compared();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NEAR(all[0].machines[0].value, 3e-6, 1e-18);
  EXPECT_EQ(all[0].spread, 0.0);
  EXPECT_EQ(all[0].machines[0].z, 0.0);
}

TEST(Comparisons, OfVeryManyTheFurthest) {
  Fleet fleet;
  for (int i = 0; i < 201; ++i)
    fleet.add("m" + std::to_string(1000 + (i * 73) % 201), (i - 100) * 0.1, over(0, 500));
  const auto all = fleet.compared();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].count, 201U);
  ASSERT_EQ(all[0].machines.size(), 60U);
  for (const auto& m : all[0].machines) EXPECT_GT(std::fabs(m.value), 7.0e-6) << m.machine;
  EXPECT_TRUE(std::is_sorted(all[0].machines.begin(), all[0].machines.end(),
                             [](const auto& a, const auto& b) { return a.machine < b.machine; }));
  EXPECT_NEAR(all[0].median, 0.0, 1e-18);
  EXPECT_NEAR(all[0].spread, 1.4826 * 5e-6, 1e-17);
}

TEST(Comparisons, DamagedConditionsAreOnesOfTheirOwn) {
  Fleet fleet;
  for (const char* name : {"a", "b"}) fleet.add(name, 1.0, over(0, 500));
  for (const char* text : {"", "[1]", "{\"from\":\"x\",\"to\":3}", "{\"from\":0}", "{"})
    fleet.add(std::string("d") + text, 1.0, text);
  const auto all = fleet.compared();
  ASSERT_EQ(all.size(), 1U);  // of the three that cannot be read
  EXPECT_EQ(all[0].count, 3U);
  EXPECT_FALSE(all[0].travel.has_value());
}

}  // namespace
}  // namespace nonio::test::site_tables_test
