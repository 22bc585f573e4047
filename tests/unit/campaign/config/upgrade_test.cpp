// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/upgrade.h"

#include <gtest/gtest.h>

#include <functional>

#include "campaign/config/manifest.h"

namespace nonio::upgrade_test {
namespace {

config::UpgradedFile of(const std::string& text,
                        const config::Key& file = config::campaign_file()) {
  const auto done = config::upgraded(text, file, "campaign.toml");
  EXPECT_TRUE(done) << done.error().message << "\n" << text;
  return done ? *done : config::UpgradedFile{};
}

constexpr const char* begin = "format = 1\n[campaign]\nid = \"c\"\n";

}  // namespace

TEST(Upgrade, RenamesKeysWhereverTheyAreWritten) {
  const std::pair<const char*, const char*> cases[] = {
      {"[machine.axes.X]\ntable_on = \"none\" # table_on = 1\n",
       "[machine.axes.X]\nactive_table = \"none\" # table_on = 1\n"},
      {"[machine.axes]\nX = { kind = \"linear\", table_on=\"table_on = 2\", backlash_on_mm = 0 }\n",
       "[machine.axes]\nX = { kind = \"linear\", active_table=\"table_on = 2\", active_backlash_mm "
       "= 0 "
       "}\n"},
      {"[machine.axes]\nX = { table_on = \"none\" } \nY = {table_on = \"none\"}\n",
       "[machine.axes]\nX = { active_table = \"none\" } \nY = {active_table = \"none\"}\n"},
      {"[machine]\naxes = { X = { table_on = \"a\" }, Y = { table_on = \"b\" } }\n",
       "[machine]\naxes = { X = { active_table = \"a\" }, Y = { active_table = \"b\" } }\n"},
      {"[machine]\naxes.C.\"backlash_on_deg\" = \"none\"\n",
       "[machine]\naxes.C.\"active_backlash_deg\" = \"none\"\n"},
      {"[[tables.may_stand]]\nfinding = \"plausibility.a\"\nreason = \"may_stand = 1\"\n"
       "  [[ tables . may_stand ]]  # second\nfinding = \"plausibility.b\"\n",
       "[[tables.accept]]\nfinding = \"plausibility.a\"\nreason = \"may_stand = 1\"\n"
       "  [[ tables . accept ]]  # second\nfinding = \"plausibility.b\"\n"},
      {"[tables]\nmay_stand = [\n  # may_stand = 3\n  { finding = \"plausibility.a\" },\n]\n",
       "[tables]\naccept = [\n  # may_stand = 3\n  { finding = \"plausibility.a\" },\n]\n"},
      {"[certificate]\nnothing_else_by = 'B. Sample'\n",
       "[certificate]\nno_other_deviations_by = 'B. Sample'\n"},
  };
  for (const auto& [before, after] : cases) {
    const config::UpgradedFile once = of(begin + std::string(before));
    EXPECT_EQ(begin + std::string(after), once.text);
    EXPECT_FALSE(once.lines.empty());
    EXPECT_TRUE(of(once.text).lines.empty()) << "the second time nothing is left to do";
    // The same with the line ends of Windows and the mark of UTF-8.
    std::string crlf = "\xef\xbb\xbf", wanted = crlf;
    for (const auto& [from, to] : {std::pair{begin + std::string(before), &crlf},
                                   std::pair{begin + std::string(after), &wanted}})
      for (const char c : from) *to += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(wanted, of(crlf).text);
  }
}

TEST(Upgrade, ListsTheChangedLines) {
  const auto done = of("[certificate]\r\nmay_stand = []\r\n", config::site_file());
  ASSERT_EQ(1U, done.lines.size());
  EXPECT_EQ(2U, done.lines[0].line);
  EXPECT_EQ("may_stand = []", done.lines[0].before);
  EXPECT_EQ("accept = []", done.lines[0].after);
}

TEST(Upgrade, RenamesIdsOfFindings) {
  const std::string site =
      "[limits]\nvanished = 3\n[[certificate.accept]]\n"
      "finding = \"rtcp.not-told\"  # rtcp.not-told\n"
      "[[certificate.accept]]\nfinding = 'rtcp.not-told-ball'\n";
  const auto done = of(site, config::site_file());
  EXPECT_EQ(
      "[limits]\nmissing_campaigns = 3\n[[certificate.accept]]\n"
      "finding = \"rtcp.not-identifiable\"  # rtcp.not-told\n"
      "[[certificate.accept]]\nfinding = 'rtcp.not-identifiable-ball'\n",
      done.text);
  EXPECT_TRUE(of(done.text, config::site_file()).lines.empty());
}

TEST(Upgrade, LeavesWhatIsNoFormerKey) {
  for (const char* text : {"# table_on\n[campaign]\nid = \"table_on\"\n", "table_on = 1\n",
                           "[machine.axes.X]\ntable_on = \"a\"\nactive_table = \"b\"\n",
                           "[options.x]\nmay_stand = 1\n"})
    EXPECT_EQ(text, of(text).text);
}

TEST(Upgrade, AFormerKeyThatIsSpelledStrangelyIsLeftToThePerson) {
  const auto done = config::upgraded("[machine.axes.X]\n\"table\\u005fon\" = \"none\"\n",
                                     config::campaign_file(), "campaign.toml");
  ASSERT_FALSE(done);
  EXPECT_EQ(2U, done.error().line);
  EXPECT_NE(std::string::npos,
            done.error().message.find("rename table_on to active_table by hand"));
}

TEST(Upgrade, FormerKeysAreReadWithAWarning) {
  const std::string text =
      begin + std::string(
                  "[machine.axes.X]\ntable_on = \"none\"\nbacklash_on_mm = 0.01\n"
                  "[[tables.may_stand]]\nfinding = \"plausibility.a\"\nreason = \"short axis\"\n"
                  "[[tables.may_stand]]\nfinding = \"plausibility.b\"\nreason = \"short axis\"\n"
                  "[run]\nanalyses = []\noutputs = []\n");
  const auto read = config::parse_without_methods(text, "campaign.toml");
  ASSERT_TRUE(read) << read.error().front().message;
  EXPECT_EQ("", read->campaign.machine.axes.at(0).active_table);
  EXPECT_DOUBLE_EQ(1e-5, *read->campaign.machine.axes.at(0).active_backlash);
  EXPECT_EQ(2U, read->accepted.size());
  ASSERT_EQ(3U, read->warnings.size());
  EXPECT_EQ(5U, read->warnings[0].line);
  EXPECT_EQ("campaign.toml", read->warnings[0].file);
  for (const char* part :
       {"machine.axes.X.table_on", "machine.axes.X.active_table", "nonio upgrade"})
    EXPECT_NE(std::string::npos, read->warnings[0].message.find(part)) << part;
  EXPECT_EQ(7U, read->warnings[2].line);
}

TEST(Upgrade, BothNamesInOneTableAreAnError) {
  const auto read = config::parse_site("[certificate]\nmay_stand = []\naccept = []\n", "site.toml");
  ASSERT_FALSE(read);
  EXPECT_EQ("unknown key certificate.may_stand", read.error().front().message.substr(0, 33));
}

/// A former name that is declared as a key of the same table would never be renamed.
TEST(Upgrade, NoFormerNameIsAKeyOfItsTable) {
  const std::function<void(const config::Key&)> look = [&](const config::Key& table) {
    for (const config::Key& key : table.keys) {
      if (!key.former.empty()) EXPECT_EQ(nullptr, config::find_key(table.keys, key.former));
      look(key);
    }
  };
  look(config::campaign_file());
  look(config::site_file());
}

}  // namespace nonio::upgrade_test
