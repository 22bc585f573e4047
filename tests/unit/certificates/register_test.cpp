// SPDX-License-Identifier: Apache-2.0
#include "certificates/register.h"

#include <gtest/gtest.h>
#include <pwd.h>
#include <unistd.h>

#include <fstream>

#include "campaign/config/number_pattern.h"
#include "certificates/a_register.h"
#include "platform/storage/database.h"

namespace nonio::register_test {
namespace {

TEST_F(RegisterTest, NothingIsMadeByLooking) {
  EXPECT_TRUE(entries().empty());
  EXPECT_TRUE(fs::is_empty(site_));
}

TEST_F(RegisterTest, WhatWasIssuedComesBackAsItWas) {
  certificates::Register r = open();
  const evaluation::Certificate c = issued(r, "c1", first_data);
  EXPECT_EQ(c.issue.number, "2026-0001");
  EXPECT_EQ(c.issue.date, day);
  EXPECT_EQ(c.issue.replaces, "");
  certificates::Register later = open();
  const evaluation::Certificate again = drawn(later, "c1", first_data, "2027-03-01");
  EXPECT_TRUE(again.issued);
  EXPECT_EQ(again.issue.number, c.issue.number);
  EXPECT_EQ(again.issue.date, day);
  EXPECT_EQ(again.issue.readings_sha256, "rr");
  EXPECT_EQ(again.output, "certificate");
  EXPECT_EQ(again.templates_sha256, "tt");
  EXPECT_EQ(again.results, "{}");
  ASSERT_EQ(again.files.size(), 2U);
  EXPECT_EQ(again.files[0].name, "certificate.pdf");
  EXPECT_EQ(again.files[0].bytes, std::string("%PDF\0\xFF", 6) + "2026-0001");
  EXPECT_EQ(again.files[1].output, "dcc");
  EXPECT_EQ(again.files[1].no_time_stamp, "no answer");
  EXPECT_EQ(entries().size(), 1U);
  EXPECT_EQ(entry("2026-0001").state, "issued");
}

/// The name is stated; the account is the operating system's.
TEST_F(RegisterTest, TheAccountIsNotedWithTheName) {
  certificates::Register r = open();
  evaluation::Certificate c = drawn(r, "c1", first_data);
  c.output = "certificate", c.results = "{}";
  c.released = R"({"released": {"by": "B. Sample"}})";
  ASSERT_TRUE(r.issue(c, "c1", first_data));
  ASSERT_TRUE(r.withdraw(c.issue.number, "wrong", "C. Other"));
  auto all = entries();
  ASSERT_TRUE(r.note_persons(all));
  const passwd* user = ::getpwuid(::getuid());
  char host[256] = {};
  ASSERT_EQ(::gethostname(host, sizeof host - 1), 0);
  const std::string account =
      (user != nullptr ? user->pw_name : "uid " + std::to_string(::getuid())) + "@" + host;
  EXPECT_EQ(all.front().released_by, "B. Sample");
  EXPECT_EQ(all.front().withdrawn_by, "C. Other");
  EXPECT_EQ(all.front().released_account, account);
  EXPECT_EQ(all.front().withdrawn_account, account);
}

TEST_F(RegisterTest, ANumberThatWasNotIssuedIsUsedAgainAndSaysWhy) {
  certificates::Register r = open();
  EXPECT_EQ(drawn(r, "c1", first_data).issue.number, "2026-0001");
  EXPECT_EQ(drawn(r, "c2", first_data).issue.number, "2026-0002");
  EXPECT_NE(entry("2026-0001").reason, "");
  EXPECT_TRUE(r.note_failure("c1", "the key is gone"));
  EXPECT_EQ(entry("2026-0001").state, "drawn");
  EXPECT_EQ(entry("2026-0001").reason, "the key is gone");
  EXPECT_NE(entry("2026-0002").reason, "the key is gone");
  const evaluation::Certificate c = issued(r, "c1", other_readings, "2026-12-24");
  EXPECT_EQ(c.issue.number, "2026-0001");
  EXPECT_EQ(entry("2026-0001").date, "2026-12-24");
  EXPECT_EQ(entry("2026-0001").reason, "");
  EXPECT_TRUE(r.note_failure("c1", "too late"));
  EXPECT_EQ(entry("2026-0001").reason, "");
}

TEST_F(RegisterTest, AClockThatWasSetBackDrawsNoNumber) {
  certificates::Register r = open();
  issued(r, "c1", first_data);
  const auto earlier = r.draw("c2", other_readings, "2026-11-20");
  ASSERT_FALSE(earlier);
  EXPECT_NE(earlier.error().message.find("2026-0001 was issued on 2026-11-21"), std::string::npos)
      << earlier.error().message;
  EXPECT_EQ(drawn(r, "c2", other_readings).issue.number, "2026-0002");
}

TEST_F(RegisterTest, OtherDataAreAnAmendmentThatNamesWhatItReplaces) {
  certificates::Register r = open();
  issued(r, "c1", first_data);
  const evaluation::Certificate second = issued(r, "c1", other_readings, "2026-11-30");
  EXPECT_EQ(second.issue.number, "2026-0002");
  EXPECT_EQ(second.issue.replaces, "2026-0001");
  EXPECT_EQ(second.issue.replaces_date, day);
  EXPECT_EQ(files_of(second.issue), std::vector<std::string>{"x.csv"});
  EXPECT_EQ(entry("2026-0001").state, "amended");
  EXPECT_EQ(entry("2026-0001").replaced_by, "2026-0002");
  EXPECT_EQ(files_of(drawn(r, "c1", other_readings).issue), files_of(second.issue));
  // The data of the first again: what was replaced does not come back.
  const reading::Inputs more = {{"campaign.toml", "aa"}, {"file y.csv", "bb"}, {"site.toml", "c2"}};
  issued(r, "c1", first_data, "2026-11-30");
  const evaluation::Certificate fourth = issued(r, "c1", more, "2026-11-30");
  EXPECT_EQ(fourth.issue.replaces, "2026-0003");
  EXPECT_EQ(files_of(fourth.issue), (std::vector<std::string>{"y.csv", "site.toml", "x.csv"}));
}

TEST_F(RegisterTest, WhatIsWithdrawnIsIssuedAnew) {
  certificates::Register r = open();
  issued(r, "c1", first_data);
  issued(r, "c2", first_data);
  drawn(r, "c3", first_data);
  EXPECT_TRUE(r.withdraw("2026-0001", "no time stamp"));
  EXPECT_EQ(entry("2026-0001").state, "withdrawn");
  EXPECT_EQ(entry("2026-0001").reason, "no time stamp");
  const evaluation::Certificate anew = issued(r, "c1", first_data);
  EXPECT_EQ(anew.issue.number, "2026-0004");
  EXPECT_EQ(anew.issue.replaces, "2026-0001");
  EXPECT_TRUE(anew.issue.changes.empty());
  EXPECT_EQ(entry("2026-0001").state, "withdrawn");
  EXPECT_EQ(entry("2026-0001").replaced_by, "2026-0004");
  for (const char* not_to_be : {"2026-0001", "2026-0003", "2026-0099"})
    EXPECT_FALSE(r.withdraw(not_to_be, "x")) << not_to_be;
  issued(r, "c2", other_readings);
  EXPECT_FALSE(r.withdraw("2026-0002", "x"));  // replaced already
}

TEST_F(RegisterTest, TheSequenceBeginsAnewWithTheYearOnlyIfItIsInThePattern) {
  certificates::Register r = open();
  EXPECT_EQ(drawn(r, "c1", first_data, "2026-12-31").issue.number, "2026-0001");
  EXPECT_EQ(drawn(r, "c2", first_data, "2027-01-01").issue.number, "2027-0001");
  EXPECT_EQ(drawn(r, "c3", first_data, "2026-12-31").issue.number, "2026-0002");
  numbering_.pattern = "LAT 1-{number}";
  certificates::Register other = open();
  EXPECT_EQ(drawn(other, "c4", first_data, "2026-12-31").issue.number, "LAT 1-1");
  EXPECT_EQ(drawn(other, "c5", first_data, "2027-01-01").issue.number, "LAT 1-2");
  // Another width is the same sequence, and a number that another pattern gave is passed over.
  numbering_.pattern = "{year}-{number:2}";
  certificates::Register narrow = open();
  EXPECT_EQ(drawn(narrow, "c6", first_data).issue.number, "2026-03");
  numbering_.pattern = "2026-0{number}";
  certificates::Register strange = open();
  EXPECT_EQ(drawn(strange, "c7", first_data).issue.number, "2026-01");
  EXPECT_EQ(drawn(strange, "c8", first_data).issue.number, "2026-02");
  EXPECT_EQ(drawn(strange, "c9", first_data).issue.number, "2026-04");
}

TEST(Number, FollowsThePatternOrIsRefused) {
  EXPECT_EQ(*config::number_text("{year}-{number:4}", "2026", 12), "2026-0012");
  EXPECT_EQ(*config::number_text("{number}", "2026", 12), "12");
  EXPECT_EQ(*config::number_text("LAT 123-{year}{number:3}", "2026", 12345), "LAT 123-202612345");
  for (const std::string pattern :
       {"", "x", "{number:0}", "{number:12}", "{number}{number}", "{month}-{number}", "../{number}",
        "a/{number}", ".{number}", " {number}", "{number} ", "a\n{number}", "a\x7f{number}",
        "N\xC2\xBA{number}", "{number}{"})
    EXPECT_FALSE(config::number_text(pattern, "2026", 1)) << pattern;
  EXPECT_FALSE(config::number_text(std::string(60, 'x') + "{number}", "2026", 1));
}

TEST_F(RegisterTest, TwoRunsAtOnceIssueOnce) {
  certificates::Register a = open(), b = open();
  evaluation::Certificate of_a = drawn(a, "c1", first_data), of_b = drawn(b, "c1", first_data);
  EXPECT_EQ(of_a.issue.number, of_b.issue.number);
  of_a.files = {{"certificate", "certificate.pdf", "A", ""}};
  of_b.files = {{"certificate", "certificate.pdf", "B", ""}};
  ASSERT_TRUE(a.issue(of_a, "c1", first_data));
  const auto second = b.issue(of_b, "c1", first_data);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->files.front().bytes, "A");
  EXPECT_FALSE(b.issue(of_b, "c1", other_readings));
  EXPECT_FALSE(b.issue(of_b, "c2", first_data));
  EXPECT_EQ(drawn(b, "c1", first_data).files.front().bytes, "A");
}

TEST_F(RegisterTest, OfTheOtherKindIsNotBegunAnew) {
  const fs::path other =
      site_ / (on_server ? numbering_.register_file : std::string("certificates.register"));
  std::ofstream(other) << "is there\n";
  const auto refused = certificates::Register::open(site_, numbering_);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("would be a new one"), std::string::npos)
      << refused.error().message;
  fs::remove(other);
  certificates::Register r = open();
  drawn(r, "c1", first_data);
  std::ofstream(other) << "came later\n";
  EXPECT_EQ(open().id(), r.id());
}

}  // namespace
}  // namespace nonio::register_test
