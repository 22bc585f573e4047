// SPDX-License-Identifier: Apache-2.0
#include "batch/state/run_plan.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace nonio::batch::run_plan_test {
namespace {

namespace fs = std::filesystem;

class RunPlanTest : public ::testing::Test {
 protected:
  RunPlanTest() {
    std::string pattern = (fs::temp_directory_path() / "nonio-plan-XXXXXX").string();
    out_ = ::mkdtemp(pattern.data());
    for (int i = 100; i < 150; ++i) {
      CampaignState c;
      c.id = "c" + std::to_string(i);
      c.folder = "f\xe9/" + std::to_string(i);
      c.reason = "no earlier result";
      campaigns_.push_back(c);
    }
    campaigns_[3].action = CampaignState::Action::unchanged;
    campaigns_[3].status = evaluation::Status::attention;
    campaigns_[3].shows_history = true;
    campaigns_[3].history = "0123";
    campaigns_[5].status = evaluation::Status::failed;
    campaigns_[5].errors = {Error{"why"}, Error{"and why"}};
    campaigns_[7].twins.emplace_back(0xfeedULL, 3);
    plan_.run = {4, "2026-01-01"};
    plan_.shards.resize(7);
  }
  ~RunPlanTest() override { fs::remove_all(out_); }

  fs::path list(const char* name) const { return out_ / ".nonio" / "plan" / plan_.id / name; }

  fs::path out_;
  std::vector<CampaignState> campaigns_;
  RunPlan plan_;
};

TEST_F(RunPlanTest, EveryCampaignIsOnTheListOfItsShardOrOnTheRest) {
  ASSERT_TRUE(write_plan(out_, plan_, campaigns_));
  EXPECT_EQ(plan_.seen, 50U);
  EXPECT_EQ(plan_.to_do, 48U);
  const auto read = read_plan(out_);
  ASSERT_TRUE(read) << read.error().message;
  std::size_t listed = 0;
  for (std::uint64_t shard = 0; shard < 7; ++shard) {
    const auto part = read_shard_list(out_, *read, shard);
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_EQ(part->size(), read->shards[shard].campaigns);
    std::string before;
    for (const Listed& one : *part) {
      EXPECT_EQ(shard_of(one.campaign.id, 7), shard);
      EXPECT_LT(before, one.campaign.id);  // in their order
      before = one.campaign.id;
      EXPECT_EQ(one.campaign.folder, "f\xe9/" + before.substr(1));
      EXPECT_EQ(one.campaign.reason, std::string("no earlier result"));
      if (before == "c107") {
        ASSERT_EQ(one.twins.size(), 1U);
        EXPECT_EQ(one.twins[0], std::pair(std::uint64_t{0xfeed}, std::string("c103")));
      }
    }
    listed += part->size();
  }
  EXPECT_EQ(listed, 48U);
  const auto rest = read_rest(out_, *read);
  ASSERT_TRUE(rest) << rest.error().message;
  ASSERT_EQ(rest->size(), 2U);
  const CampaignState& unchanged = (*rest)[0].campaign;
  EXPECT_EQ(unchanged.id, std::string("c103"));
  EXPECT_EQ(unchanged.action, CampaignState::Action::unchanged);
  EXPECT_EQ(unchanged.status, evaluation::Status::attention);
  EXPECT_TRUE(unchanged.shows_history);
  EXPECT_EQ(unchanged.history, std::string("0123"));
  ASSERT_EQ((*rest)[1].campaign.errors.size(), 2U);
  EXPECT_EQ((*rest)[1].campaign.errors[1].message, "and why");
}

TEST_F(RunPlanTest, NothingButListsAndPlanIsLeft) {
  ASSERT_TRUE(write_plan(out_, plan_, campaigns_));
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(out_ / ".nonio" / "plan" / plan_.id)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 8U);
}

TEST_F(RunPlanTest, AListThatWasChangedIsRefused) {
  ASSERT_TRUE(write_plan(out_, plan_, campaigns_));
  std::ofstream(list("shard-0002.jsonl"), std::ios::app) << "\n";
  const auto part = read_shard_list(out_, plan_, 2);
  ASSERT_FALSE(part);
  EXPECT_NE(part.error().message.find("plan the run again"), std::string::npos)
      << part.error().message;
}

TEST_F(RunPlanTest, WithoutAPlaceToWriteThereIsNoPlan) {
  std::ofstream(out_ / ".nonio") << "a file";
  const auto written = write_plan(out_, plan_, campaigns_);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find(".nonio"), std::string::npos) << written.error().message;
}

}  // namespace
}  // namespace nonio::batch::run_plan_test
