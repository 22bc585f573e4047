// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/history_so_far.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../store/laboratory.h"

/// What a report may say of its machine: what its day knew, and nothing else.
namespace nonio::test::history_so_far_test {
namespace {

namespace morning = assessment;
namespace config = config;

class HistorySoFarTest : public ::testing::Test {
 protected:
  HistorySoFarTest() : out_("so_far") {}

  void measure(const std::string& id, const std::string& day, double b_mean,
               const std::string& asset = "S-1", const std::string& readings = "r") {
    Made made;
    made.id = id, made.day = day, made.b_mean = b_mean, made.asset = asset;
    ASSERT_TRUE(out_.store(made, run_, readings + id)) << out_.why();
    const auto stored = store::update(out_.root(), false, {id}, records_, nothing);
    ASSERT_TRUE(stored) << stored.error().message;
    ++run_;
  }
  void tell() {
    const auto stored = store::update(out_.root(), false, {}, records_, nothing);
    ASSERT_TRUE(stored) << stored.error().message;
  }

  assessment::HistoryBasis basis(const std::string& id) {
    const auto all = assessment::history_bases(out_.root(), {id});
    EXPECT_TRUE(all) << (all ? "" : all.error().message);
    EXPECT_EQ(all->size(), 1U);
    return all->empty() ? assessment::HistoryBasis() : all->front();
  }
  static std::string ids(const assessment::HistoryBasis& b) {
    std::string out;
    for (const auto& [id, digest] : b.campaigns) out += id + ' ';
    return out;
  }
  HistorySoFar history(const std::string& id) {
    auto all = assessment::history_so_far(out_.root(), basis(id));
    EXPECT_TRUE(all) << (all ? "" : all.error().message);
    return all ? std::move(*all) : HistorySoFar();
  }

  Output out_;
  store::SiteRecords records_{};
  std::uint64_t run_ = 1;
};

TEST_F(HistorySoFarTest, OnlyWhatItsDayKnew) {
  measure("c", "2025-07-01", -5.0);
  measure("a", "2024-01-01", -5.1);
  const std::string first = basis("c").sha256;
  EXPECT_EQ(ids(basis("c")), "a ");
  EXPECT_EQ(ids(basis("a")), "");
  // Later ones and other machines change nothing; an earlier one does, whenever it comes.
  measure("d", "2026-01-01", -9.0);
  measure("x", "2024-05-01", -9.0, "S-2");
  EXPECT_EQ(basis("c").sha256, first);
  measure("b", "2024-07-01", -5.2);
  EXPECT_EQ(ids(basis("c")), "a b ");
  EXPECT_NE(basis("c").sha256, first);
  // Of its own day all count; a corrected one is another one.
  measure("b2", "2025-07-01", -5.2);
  EXPECT_EQ(ids(basis("c")), "a b b2 ");
  const std::string before = basis("c").sha256;
  measure("b", "2024-07-01", -5.3, "S-1", "other readings");
  EXPECT_NE(basis("c").sha256, before);
}

TEST_F(HistorySoFarTest, EventsAliasesAndRules) {
  measure("a", "2024-01-01", -5.1, "S-2");
  measure("c", "2025-07-01", -5.0);
  std::string before = basis("c").sha256;
  const auto changed = [&] {
    tell();
    const std::string now = basis("c").sha256;
    return std::exchange(before, now) != now;
  };
  records_.logs.events.push_back({"2025-08-01", "S-1", "X", "crash", "later", "B", 1});
  EXPECT_FALSE(changed());
  records_.logs.events.push_back({"2025-06-01", "S-2", "X", "crash", "of another machine", "B", 2});
  EXPECT_FALSE(changed());
  records_.logs.events.push_back({"2025-06-01", "S-1", "X", "crash", "of this one", "B", 3});
  EXPECT_TRUE(changed());
  records_.aliases.push_back({"S-2", "S-1", "one plate"});
  EXPECT_TRUE(changed());
  EXPECT_EQ(ids(basis("c")), "a ");
  records_.due.push_back({"", 6});
  EXPECT_TRUE(changed());
  const HistorySoFar h = history("c");
  EXPECT_EQ(h.due, "2026-01-01");
  EXPECT_EQ(h.aliases, std::vector<std::string>{"S-2"});
  ASSERT_EQ(h.events.size(), 2U);  // the other machine is this one now
  EXPECT_EQ(h.events.back().text, "of this one");
}

TEST_F(HistorySoFarTest, TheSameWhateverTheRuns) {
  const std::vector<std::tuple<std::string, std::string, double>> campaigns = {
      {"a", "2023-01-10", -5.0}, {"b", "2023-07-10", -5.1}, {"c", "2024-01-10", -4.9},
      {"d", "2024-07-10", -9.1}, {"e", "2025-01-10", -9.0}, {"f", "2025-07-10", -9.2}};
  for (const auto& [id, day, b] : campaigns) measure(id, day, b);
  const HistorySoFar forward = history("f");
  out_.lose_store();
  fs::remove_all(out_.root());
  fs::create_directories(out_.root() / ".nonio");
  run_ = 1;
  for (auto it = campaigns.rbegin(); it != campaigns.rend(); ++it)
    measure(std::get<0>(*it), std::get<1>(*it), std::get<2>(*it));
  const HistorySoFar backward = history("f");
  EXPECT_EQ(forward.sha256, backward.sha256);
  ASSERT_EQ(forward.series.size(), backward.series.size());
  for (std::size_t i = 0; i < forward.series.size(); ++i) {
    const HistorySeries &one = forward.series[i], &other = backward.series[i];
    EXPECT_EQ(one.quantity, other.quantity);
    EXPECT_EQ(one.model, other.model);
    EXPECT_EQ(one.smallest_change, other.smallest_change);
    ASSERT_EQ(one.changes.size(), other.changes.size());
    for (std::size_t k = 0; k < one.changes.size(); ++k) {
      EXPECT_EQ(one.changes[k].size, other.changes[k].size);
      EXPECT_EQ(one.changes[k].p, other.changes[k].p);
    }
    if (one.quantity != "B_mean") continue;
    ASSERT_EQ(one.changes.size(), 1U);  // the step of -4.1 um between c and d
    EXPECT_EQ(one.changes.front().after_campaign, "c");
    EXPECT_NEAR(one.changes.front().size, -4.1e-6, 0.4e-6);
  }
}

TEST_F(HistorySoFarTest, ADifferenceLeavesOutWhatBothHaveInCommon) {
  measure("a", "2024-01-01", -5.0);
  measure("b", "2025-01-01", -6.5);
  const HistorySoFar h = history("b");
  ASSERT_EQ(h.steps.size(), 2U);
  for (const HistoryStep& step : h.steps) {
    EXPECT_EQ(step.before, "a");
    EXPECT_EQ(step.before_date, "2024-01-01");
    EXPECT_EQ(h.series[step.series].points[step.point].campaign, "b");
    // Made: the scale has u 0.1 um/m, and 0.5 um/m in common with every campaign of that instrument.
    const double u = step.quantity == "scale" ? 0.1e-6 : 0.2e-6;
    EXPECT_NEAR(step.u, std::sqrt(2.0) * u, 1e-12) << step.quantity;
    EXPECT_NEAR(step.size, step.quantity == "scale" ? 0.0 : -1.5e-6, 1e-12) << step.quantity;
  }
}

TEST_F(HistorySoFarTest, WithoutDayOrMachineThereIsNone) {
  measure("a", "2024-01-01", -5.0);
  measure("b", "", -5.0);
  EXPECT_EQ(ids(basis("b")), "");
  EXPECT_EQ(ids(basis("a")), "");
  EXPECT_TRUE(history("b").series.empty());
  EXPECT_EQ(history("b").machine, "S-1");
  EXPECT_TRUE(assessment::history_bases(out_.root(), {"nobody"})->empty());
}

}  // namespace
}  // namespace nonio::test::history_so_far_test
