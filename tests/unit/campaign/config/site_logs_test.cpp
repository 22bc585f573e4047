// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/site_logs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "platform/storage/files.h"

namespace nonio::test::site_logs_test {

namespace {
namespace fs = std::filesystem;
namespace config = config;

class SiteFolder {
 public:
  SiteFolder() : root_(fs::temp_directory_path() / ("nonio-logs-" + std::to_string(::getpid()))) {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~SiteFolder() { fs::remove_all(root_); }
  SiteFolder(const SiteFolder&) = delete;
  SiteFolder& operator=(const SiteFolder&) = delete;
  const fs::path& root() const { return root_; }
  void write(const char* name, const std::string& text) const {
    std::ofstream(root_ / name, std::ios::binary) << text;
  }
  std::string read(const char* name) const {
    return storage::read_file(root_ / name).value_or("(none)");
  }

 private:
  fs::path root_;
};

config::Event an_event() {
  return {.date = "2026-03-04",
          .machine = "S-0042",
          .axis = "X",
          .kind = "crash",
          .text = "tool hit the vice",
          .by = "B. Sample"};
}

std::string first_error(const config::Checked<void>& done) {
  if (done) return "";
  const Error& e = done.error().front();
  return e.file + ":" + std::to_string(e.line) + ": " + e.message;
}

}  // namespace

TEST(SiteLogs, AnEntryGoesToTheEndAndCommentsStay) {
  const SiteFolder site;
  ASSERT_TRUE(config::add_event(site.root(), an_event()));
  EXPECT_EQ(site.read("events.toml"),
            "format = 1\n\n[[event]]\ndate = 2026-03-04\nmachine = \"S-0042\"\naxis = \"X\"\n"
            "kind = \"crash\"\ntext = \"tool hit the vice\"\nby = \"B. Sample\"\n");
  const std::string hand =
      "# ours\nformat = 1 # one\n\n[[event]] # first\ndate = 2020-01-02\n"
      "machine = 'A'\nkind = \"other\"\ntext = \"x y\"   # no newline at the end";
  site.write("events.toml", hand);
  ASSERT_TRUE(config::add_event(site.root(), an_event()));
  EXPECT_TRUE(site.read("events.toml").starts_with(hand + "\n\n[[event]]\n"));
  const auto logs = config::read_site_logs(site.root());
  ASSERT_TRUE(logs);
  ASSERT_EQ(logs->events.size(), 2U);
  EXPECT_EQ(logs->events[0].line, 4U);
  EXPECT_EQ(logs->events[1].text, "tool hit the vice");
}

TEST(SiteLogs, WhatIsWrongIsRefusedAndNothingIsWritten) {
  const SiteFolder site;
  const auto refused = [&](config::Event e) {
    const std::string why = first_error(config::add_event(site.root(), e));
    EXPECT_FALSE(fs::exists(site.root() / "events.toml")) << why;
    return why;
  };
  config::Event e = an_event();
  e.text = "one\ntwo";
  EXPECT_NE(refused(e).find("expected one line of text, found a line break"), std::string::npos);
  e = an_event();
  e.kind = "crsh";
  EXPECT_NE(refused(e).find("nearest: \"crash\""), std::string::npos);
  e = an_event();
  e.date = "2026-02-30";
  EXPECT_NE(refused(e), "");
  e = an_event();
  e.machine.clear();
  EXPECT_NE(refused(e).find("machine"), std::string::npos);
  config::Acknowledgement a{"2026-03-04", "f", "S", "", "", "2026-03-03", {}, {}, "B", "because"};
  EXPECT_NE(first_error(config::add_acknowledgement(site.root(), a)).find("not before date"),
            std::string::npos);
  a.until = "2026-04-01";
  a.why = "--";
  EXPECT_NE(first_error(config::add_acknowledgement(site.root(), a)).find("a reason in words"),
            std::string::npos);
  EXPECT_NE(first_error(config::add_forgotten(site.root(), {"2026-03-04", "A B", "B", "sold"})),
            "");
}

TEST(SiteLogs, AFileThatIsWrongIsLeftAsItIs) {
  const SiteFolder site;
  for (const std::string& text :
       {std::string("format = 1\n[[event]\n"), std::string("format = 2\n"),
        std::string("format = 1\n[[evnt]]\n"), std::string("[[event]]\ndate = \"2026-01-01\"\n"),
        std::string("format = 1\nevent = 3\n"), std::string("\xff\xfe"), std::string(1, '\0')}) {
    site.write("events.toml", text);
    EXPECT_NE(first_error(config::add_event(site.root(), an_event())), "");
    EXPECT_EQ(site.read("events.toml"), text);
  }
  std::string large = "format = 1\n";
  while (large.size() < 10'000'000)
    large += "[[event]]\ndate = 2026-01-01\nmachine = \"S\"\nkind = \"other\"\ntext = \"t\"\n";
  site.write("events.toml", large);
  const std::string why = first_error(config::add_event(site.root(), an_event()));
  EXPECT_NE(why.find("events.toml"), std::string::npos) << why;
  EXPECT_EQ(fs::file_size(site.root() / "events.toml"), large.size());
  EXPECT_FALSE(config::read_site_logs(site.root()));
}

TEST(SiteLogs, AnyTextComesBackAsItWas) {
  const SiteFolder site;
  const std::string text = R"(quotes " and \ and ''' and # [x] = \u0041 €)";
  config::Event e = an_event();
  e.text = text;
  ASSERT_TRUE(config::add_event(site.root(), e));
  const auto logs = config::read_site_logs(site.root());
  ASSERT_TRUE(logs);
  EXPECT_EQ(logs->events.at(0).text, text);
  config::Acknowledgement a{.date = "2026-03-04",
                            .finding = "f",
                            .machine = "S",
                            .axis = "X",
                            .quantity = "B_mean",
                            .until = "2026-06-01",
                            .value = -5.25,
                            .U = 0.4,
                            .by = "B",
                            .why = "nut is ordered"};
  ASSERT_TRUE(config::add_acknowledgement(site.root(), a));
  a.value = 5.0;
  ASSERT_TRUE(config::add_acknowledgement(site.root(), a));
  const auto known = config::read_site_logs(site.root());
  ASSERT_TRUE(known);
  ASSERT_EQ(known->acknowledged.size(), 2U);
  EXPECT_NE(site.read("acknowledged.toml").find("value = -5.25\nU = 0.4\n"), std::string::npos);
  EXPECT_EQ(known->acknowledged[0].value, -5.25);
  EXPECT_EQ(known->acknowledged[1].value, 5.0);
}

TEST(SiteLogs, WhatIsWithdrawnCountsNoMore) {
  const SiteFolder site;
  const config::Acknowledgement known{.date = "2026-03-04",
                                      .finding = "worklist.out",
                                      .machine = "S-0042",
                                      .axis = "X",
                                      .quantity = {},
                                      .until = "2026-06-30",
                                      .by = "B. Sample",
                                      .why = "nut is ordered"};
  auto other = known;
  other.axis.clear();
  config::Withdrawal back{.date = "2026-03-05",
                          .finding = "worklist.out",
                          .machine = "S-0042",
                          .axis = "X",
                          .quantity = {},
                          .by = "B. Sample",
                          .why = {}};
  EXPECT_NE(first_error(config::add_withdrawal(site.root(), back)).find("takes back no"),
            std::string::npos);
  ASSERT_TRUE(config::add_acknowledgement(site.root(), known));
  ASSERT_TRUE(config::add_acknowledgement(site.root(), other));
  ASSERT_TRUE(config::add_acknowledgement(site.root(), known));
  ASSERT_TRUE(config::add_withdrawal(site.root(), back)) << "both of them";
  auto logs = config::read_site_logs(site.root());
  ASSERT_TRUE(logs);
  ASSERT_EQ(logs->acknowledged.size(), 1U);
  EXPECT_EQ(logs->acknowledged[0].axis, "");
  EXPECT_NE(first_error(config::add_withdrawal(site.root(), back)), "") << "twice";
  ASSERT_TRUE(config::add_acknowledgement(site.root(), known)) << "again, below the withdrawal";
  logs = config::read_site_logs(site.root());
  ASSERT_TRUE(logs);
  EXPECT_EQ(logs->acknowledged.size(), 2U);
  back.by.clear();
  EXPECT_NE(first_error(config::add_withdrawal(site.root(), back)).find("by"), std::string::npos);
  site.write("acknowledged.toml",
             "format = 1\n[[withdrawn]]\ndate = 2026-03-05\nfinding = \"f\"\n"
             "machine = \"m\"\nby = \"b\"\n");
  const auto wrong = config::read_site_logs(site.root());
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().front().line, 2U);
}

TEST(SiteLogs, AnAliasLeadsToAMachineAndNoFurther) {
  const auto site = config::parse_site(
      "[[alias]]\nname = \"a\"\nasset = \"S\"\nwhy = \"plate\"\n[limits]\nmissing_campaigns = 3\n",
      "site.toml");
  ASSERT_TRUE(site);
  ASSERT_EQ(site->aliases.size(), 1U);
  EXPECT_EQ(site->limits.missing_campaigns, 3U);
  const auto wrong = config::parse_site(
      "[[alias]]\nname = \"a\"\nasset = \"b\"\nwhy = \"plate\"\n[[alias]]\nname = \"b\"\nasset = "
      "\"c\"\nwhy = \"plate\"\n[[alias]]\nname = \"b\"\nasset = \"d\"\nwhy = \"-\"\n",
      "site.toml");
  ASSERT_FALSE(wrong);
  std::string all;
  for (const Error& e : wrong.error()) all += std::to_string(e.line) + ": " + e.message + "\n";
  EXPECT_NE(all.find("\"b\" is itself the name of an alias"), std::string::npos) << all;
  EXPECT_NE(all.find("\"b\" is given twice"), std::string::npos) << all;
  EXPECT_NE(all.find("expected how this is known"), std::string::npos) << all;
}

TEST(SiteLogs, AMachineIsDueByOneRule) {
  const auto site = config::parse_site(
      "[[due]]\nmonths = 12\n[[due]]\nmachine = \"S-1\"\nmonths = 6\n", "site.toml");
  ASSERT_TRUE(site);
  ASSERT_EQ(site->due.size(), 2U);
  EXPECT_EQ(site->due[0].machine, "");
  EXPECT_EQ(site->due[0].months, 12);
  EXPECT_EQ(site->due[1].machine, "S-1");
  EXPECT_EQ(site->due[1].months, 6);
  const auto wrong = config::parse_site(
      "[[due]]\nmonths = 12\n[[due]]\nmonths = 6\n[[due]]\nmachine = \"S-1\"\nmonths = 0\n"
      "[[due]]\nmachine = \"S-2\"\n",
      "site.toml");
  ASSERT_FALSE(wrong);
  std::string all;
  for (const Error& e : wrong.error()) all += std::to_string(e.line) + ": " + e.message + "\n";
  EXPECT_NE(all.find("a rule for all machines is given twice"), std::string::npos) << all;
  EXPECT_NE(all.find("expected 1 to 240 months"), std::string::npos) << all;
  EXPECT_NE(all.find("is missing"), std::string::npos) << all;
}

}  // namespace nonio::test::site_logs_test
