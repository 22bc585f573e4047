// SPDX-License-Identifier: Apache-2.0
#include "batch/state/campaign_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "batch/survey/twins.h"

namespace nonio::batch::campaign_state_test {
namespace {

/// Every pair of campaigns compared.
std::vector<CampaignState::Twin> plainly(const std::vector<std::vector<std::uint64_t>>& files,
                                         std::uint32_t of) {
  std::map<std::uint64_t, std::uint32_t> twins;
  for (const std::uint64_t digest : files[of])
    for (std::uint32_t other = 0; other < files.size(); ++other)
      if (other != of && std::count(files[other].begin(), files[other].end(), digest) > 0) {
        twins.emplace(digest, other);
        break;
      }
  return {twins.begin(), twins.end()};
}

TEST(Twins, AreThoseOfAComparisonOfAllPairs) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::vector<std::uint64_t>> files(random() % 12);
    std::vector<CampaignState> campaigns(files.size());
    const auto kinds = 1 + random() % 40;
    for (std::size_t i = 0; i < files.size(); ++i) {
      for (auto n = random() % 5; n > 0; --n) files[i].push_back(random() % kinds);
      campaigns[i].readings = files[i];
    }
    find_twins(campaigns);
    for (std::uint32_t i = 0; i < files.size(); ++i) {
      auto found = campaigns[i].twins;
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, plainly(files, i)) << "campaign " << i;
      EXPECT_TRUE(campaigns[i].readings.empty());
    }
  }
}

}  // namespace
}  // namespace nonio::batch::campaign_state_test
