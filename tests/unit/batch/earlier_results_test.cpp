// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/earlier_results.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nonio::batch::earlier_results_test {
namespace {

CampaignState campaign(const std::string& id, const std::string& folder) {
  CampaignState c;
  c.id = id;
  c.folder = folder;
  return c;
}

TEST(ClaimedIds, AreThoseThatAManifestGives) {
  std::vector<CampaignState> all{campaign("m-2", "a"), campaign("x", "b"), campaign("m-1", "c")};
  all[1].named_by_folder = true;
  const ClaimedIds claimed(all);
  EXPECT_TRUE(claimed.contains("m-1"));
  EXPECT_TRUE(claimed.contains("m-2"));
  EXPECT_FALSE(claimed.contains("x"));
  EXPECT_FALSE(claimed.contains(""));
  EXPECT_FALSE(claimed.contains("m-3"));
  EXPECT_FALSE(ClaimedIds({}).contains("m-1"));
}

/// In the order of folders, then one that could not be listed.
struct Site {
  std::vector<CampaignState> campaigns{campaign("a", "2025/a"), campaign("b", "2026/b"),
                                       campaign("latin", "2026/b\xe9"), campaign("2024", "2024")};
  std::vector<SiteWalk::Unlisted> unlisted{{"2024", "Permission denied"}};
  std::vector<std::string> notes;

  std::vector<Vanished> vanished(const std::vector<EarlierResult>& earlier) {
    return vanished_of(earlier, campaigns, 3, unlisted, "/out", notes);
  }
};

TEST(Vanished, ResultsOfAMissingFolderAreNamed) {
  Site site;
  const auto gone = site.vanished({{"c", "2026/c", 7, false}});
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_EQ(gone[0].id, "c");
  EXPECT_EQ(gone[0].run, 7U);
  EXPECT_NE(gone[0].why.find("its folder 2026/c no longer exists"), std::string::npos)
      << gone[0].why;
}

TEST(Vanished, AnotherIdInTheSameFolderIsSaid) {
  Site site;
  const auto gone = site.vanished({{"old", "2026/b", 7, false}});
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_NE(gone[0].why.find("its folder 2026/b is the campaign b now"), std::string::npos)
      << gone[0].why;
  EXPECT_TRUE(site.vanished({{"failed", "2026/b", 7, true}}).empty());
  ASSERT_EQ(site.notes.size(), 1U);
  EXPECT_NE(site.notes[0].find("/out/failed is left over"), std::string::npos) << site.notes[0];
}

TEST(Vanished, FoldersAreFoundByTheirTextToo) {
  Site site;
  EXPECT_TRUE(site.vanished({{"a", "2025/a", 7, false}}).empty());
  EXPECT_TRUE(site.vanished({{"latin", "2026/b\\xe9", 7, false}}).empty());
  EXPECT_TRUE(site.vanished({{"2024", "2024", 7, true}}).empty());
}

TEST(Vanished, FilesOfAnUnlistedFolderWereNotSeen) {
  Site site;
  const auto gone = site.vanished({{"d", "2024/d", 7, false}});
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_NE(gone[0].why.find("the folder 2024 could not be listed"), std::string::npos)
      << gone[0].why;
}

}  // namespace
}  // namespace nonio::batch::earlier_results_test
