// SPDX-License-Identifier: Apache-2.0
#include "live/campaign_index.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "platform/storage/files.h"

namespace nonio::live {
namespace {
namespace fs = std::filesystem;

void write_campaign(const fs::path& site, const std::string& id) {
  fs::create_directories(site / id);
  std::ofstream(site / id / "campaign.toml")
      << "format = 1\n[campaign]\nid = \"" << id << "\"\ncustomer = \"c\"\ndate = 2026-01-01\n";
}

template <class Condition>
void wait_for(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// The time limit of the test ends what never becomes true.
TEST(CampaignIndex, LeavesFilesAloneWhileNoPageIsOpen) {
  const storage::ScratchFolder folder("index");
  const fs::path site = folder.path();
  write_campaign(site, "one");
  std::atomic<bool> watched = false;
  std::atomic<int> asked = 0;
  CampaignIndex index(
      site, {}, [] {},
      [&] {
        ++asked;
        return watched.load();
      },
      std::chrono::milliseconds(1));
  wait_for([&] { return index.find({}).complete; });
  EXPECT_EQ(1U, index.size()) << "read once, so that the first page is there at once";
  write_campaign(site, "two");
  const int before = asked;
  wait_for([&] { return asked > before + 20; });
  EXPECT_EQ(1U, index.size());
  watched = true;
  wait_for([&] { return index.size() == 2; });
  watched = false;
  write_campaign(site, "three");
  index.look_if_old();  // a request without a page
  wait_for([&] {
    index.look_if_old();
    return index.size() == 3;
  });
}

}  // namespace
}  // namespace nonio::live
