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

TEST(KeptText, GivesBackTextsOfEveryLength) {
  std::vector<std::pair<std::string, KeptText>> all;
  for (const std::size_t length : {0UL, 1UL, 15UL, 254UL, 255UL, 256UL, 70'000UL, 1UL << 20})
    for (const char c : {'a', '\0', '\xff'}) {
      const std::string text(length, c);
      all.emplace_back(text, KeptText(text));
    }
  for (const auto& [text, kept] : all) {
    EXPECT_EQ(kept.view(), text) << text.size();
    EXPECT_EQ(kept.empty(), text.empty());
  }
}

TEST(KeptText, IsOrderedByItsBytes) {
  EXPECT_LT(KeptText(""), KeptText("a"));
  EXPECT_LT(KeptText("a"), KeptText("aa"));
  EXPECT_LT(KeptText("z"), KeptText("\xe9"));
  EXPECT_EQ(KeptText("x"), std::string("x"));
  EXPECT_EQ(KeptText("x") + "y", "xy");
}

TEST(KeptText, SharedTextsAreKeptOnceButNotWithoutEnd) {
  const char* const first = KeptText::shared("nothing changed").view().data();
  EXPECT_EQ(KeptText::shared("nothing changed").view().data(), first);
  for (int i = 0; i < 2000; ++i) {
    const std::string text = "reason " + std::to_string(i);
    EXPECT_EQ(KeptText::shared(text).view(), text);
  }
  EXPECT_EQ(KeptText::shared("nothing changed").view().data(), first);
  EXPECT_NE(KeptText::shared("reason 1999").view().data(),
            KeptText::shared("reason 1999").view().data());
}

TEST(CampaignState, ACopyHasErrorsOfItsOwn) {
  CampaignState a;
  a.set_errors({Error{"first"}});
  a.add_twin({1, 2});
  CampaignState b = a;
  b.set_errors({Error{"second"}});
  b.add_twin({3, 4});
  EXPECT_EQ(a.errors().front().message, "first");
  EXPECT_EQ(a.twins().size(), 1U);
  EXPECT_EQ(b.errors().front().message, "second");
  a = std::move(b);
  EXPECT_EQ(a.twins().size(), 2U);
  a = CampaignState();
  EXPECT_TRUE(a.errors().empty());
}

TEST(CampaignState, KeepsReadingsUntilTheyAreTaken) {
  CampaignState c;
  EXPECT_TRUE(c.readings().empty());
  using Digests = std::vector<std::uint64_t>;
  for (const Digests& digests : {Digests{0}, Digests{7}, Digests{0, 1, ~std::uint64_t{0}, 1}}) {
    c.set_readings(digests);
    EXPECT_EQ(CampaignState(c).readings(), digests);
  }
  c.set_readings({});
  EXPECT_TRUE(c.readings().empty());
}

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
      campaigns[i].set_readings(files[i]);
    }
    find_twins(campaigns);
    for (std::uint32_t i = 0; i < files.size(); ++i) {
      auto found = campaigns[i].twins();
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, plainly(files, i)) << "campaign " << i;
      EXPECT_TRUE(campaigns[i].readings().empty());
    }
  }
}

}  // namespace
}  // namespace nonio::batch::campaign_state_test
