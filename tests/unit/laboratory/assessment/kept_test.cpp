// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "../store/laboratory.h"
#include "batch/close/worklist_update.h"
#include "campaign/config/template_files.h"
#include "laboratory/assessment/assess.h"
#include "platform/storage/disk.h"

/// What a large site keeps of its machines changes no byte of what it says.
namespace nonio::test::kept_test {
namespace {

namespace batch = batch;
namespace morning = assessment;

/// Every page and output of a run, by name.
using Said = std::map<std::string, std::string>;

class KeptMachinesTest : public ::testing::Test {
 protected:
  KeptMachinesTest() : out_("kept") {
    auto templates = config::read_templates({fs::path(NONIO_WORDS).parent_path()});
    EXPECT_TRUE(templates);
    context_.templates = std::move(*templates);
  }

  void store(const Made& made, const std::string& readings) {
    ASSERT_TRUE(out_.store(made, run_, readings)) << out_.why();
    changed_.push_back(made.id);
  }

  /// Compares a run that uses the stored machines of earlier runs with one that has none.
  Said end_run(const std::string& date) {
    const auto stored = store::update(out_.root(), false, changed_, records_, nothing);
    EXPECT_TRUE(stored) << stored.error().message;
    changed_.clear();
    const fs::path fresh = out_.root().string() + "-fresh";
    fs::remove_all(fresh);
    fs::copy(out_.root(), fresh, fs::copy_options::recursive);
    for (const char* kept : {".nonio/machines.sqlite", "machines", "index.html"})
      fs::remove_all(fresh / kept);
    const Said anew = make(fresh, date);
    const Said said = make(out_.root(), date);
    for (const auto& [name, text] : anew)
      EXPECT_EQ(said.contains(name) ? said.at(name) : "none", text) << name << " on " << date;
    EXPECT_EQ(said.size(), anew.size());
    fs::remove_all(fresh);
    ++run_;
    return said;
  }

  Said make(const fs::path& out, const std::string& date) {
    batch::RunOptions options;
    options.out = out;
    assessment::LastRun last_run;
    last_run.run = run_, last_run.date = date, last_run.campaigns = 1;
    const auto made = batch::make_worklist(options, context_, last_run, 0);
    EXPECT_TRUE(made) << made.error().message;
    if (!made) return {};
    Said said{{"text", made->text}, {"json", made->json}};
    for (const char* name :
         {"index.html", "due.html", "due.ics", "instruments.html", "compare.html"})
      said[name] = read(out / name);
    for (const auto& entry : fs::directory_iterator(out / "machines"))
      said[entry.path().filename().string()] = read(entry.path());
    return said;
  }

  /// Bytes of what is kept that are others now: at its begin, in its tables, in what they hold; at last
  /// half of the file is not there.
  void damage(int k) const {
    const fs::path path = out_.root() / ".nonio" / "machines.sqlite";
    std::string bytes = read(path);
    if (k < 12)
      for (std::size_t at = 5; at < bytes.size(); at += bytes.size() / 7) bytes[at] ^= 1;
    else
      bytes.resize(bytes.size() / 2);
    Output::write(path, bytes);
  }

  static std::string read(const fs::path& path) {
    return storage::read_file(path).value_or("none");
  }

  Output out_;
  store::SiteRecords records_{};
  reading::Context context_{};
  std::vector<std::string> changed_{};
  std::uint64_t run_ = 1;
};

TEST_F(KeptMachinesTest, ChangeNoByteOfAnyRun) {
  constexpr std::uint64_t seed = 1923;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const auto any = [&](std::size_t n) { return random() % n; };
  std::normal_distribution<double> noise(0.0, 0.1);
  std::vector<Made> campaigns;
  const auto machine_name = [](std::size_t k) { return "S-" + std::to_string(k); };
  const auto measure = [&](std::size_t machine, int month, double step) {
    const std::string number = std::to_string(campaigns.size());
    Made made{.id = "c" + number,
              .day = std::to_string(2020 + month / 12) + "-" + (month % 12 < 9 ? "0" : "") +
                     std::to_string(month % 12 + 1) + "-15",
              .asset = machine_name(machine),
              .serial = std::to_string(400 + machine)};
    made.scale = 1.25 + noise(random), made.b_mean = -5.0 + noise(random) + step;
    if (step > 0.0) made.A = "11.5", made.decision = "does not conform";
    campaigns.push_back(made);
    store(made, "r" + number);
  };
  for (int month = 0; month < 60; month += 6)
    for (std::size_t m = 0; m < 8; ++m) measure(m, month, m == 3 && month > 30 ? 3.0 : 0.0);
  end_run("2025-01-01");
  std::size_t lines = 0;
  for (int k = 0; k < 24; ++k) {
    const std::string date = "2025-" + std::string(k < 18 ? "0" : "") + std::to_string(1 + k / 2) +
                             (k % 2 == 0 ? "-05" : "-20");
    switch (k % 12) {
      case 0:  // nothing but another date
        break;
      case 1:
        measure(any(8), 60 + k / 2, 0.0);
        break;
      case 2:  // a crash
        measure(k < 12 ? 5 : 6, 60 + k / 2, 4.0);
        break;
      case 3: {  // other readings
        Made& made = campaigns[any(campaigns.size())];
        made.scale += 0.05;
        store(made, "again" + std::to_string(k));
        break;
      }
      case 4:
        records_.logs.events.push_back({"2024-0" + std::to_string(1 + any(9)) + "-01",
                                        machine_name(any(8)), "X", k < 12 ? "crash" : "repair",
                                        "what happened", "B", 3});
        break;
      case 5:
        records_.due = {{"", 6}, {"S-2", 3}};
        if (k > 12) records_.due.pop_back();
        break;
      case 6:
        records_.logs.acknowledged.push_back({"2025-03-01",
                                              "worklist.out",
                                              "S-3",
                                              "X",
                                              "",
                                              "2025-07-31",
                                              {},
                                              {},
                                              "B",
                                              "is ordered",
                                              2});
        break;
      case 7:
        records_.aliases = k < 12 ? std::vector<config::Alias>{{"S-7", "S-1", "one plate"}}
                                  : std::vector<config::Alias>{};
        break;
      case 8:  // a certificate, and a report with old results
        campaigns.back().certificate = "2025-" + std::to_string(k);
        store(campaigns.back(), "r" + campaigns.back().id.substr(1));
        Output::write(out_.root() / campaigns[any(20)].id / "report.pdf", "%PDF");
        break;
      case 9:  // a new machine, and one that was removed
        measure(8 + static_cast<std::size_t>(k), 60 + k / 2, 0.0);
        if (k < 12)
          for (const Made& made : campaigns)
            if (made.asset == "S-4")
              records_.logs.forgotten.push_back({"2025-05-01", made.id, "B", "sold", 4});
        break;
      case 10:  // a page was changed, and one was deleted
        Output::write(out_.root() / "machines" / "S-0.html", "what somebody wrote");
        fs::remove(out_.root() / "machines" / "S-2.html");
        break;
      default:  // what is kept is damaged
        damage(k);
        break;
    }
    lines += end_run(date).at("json").size();
    if (HasFailure()) break;
  }
  EXPECT_GT(lines, 24U * 500U);
}

/// A machine was not calibrated by a campaign without results.
TEST_F(KeptMachinesTest, AFailedCampaignMovesNoDueDate) {
  records_.due = {{"", 6}};
  store({.id = "good", .day = "2026-01-05"}, "r1");
  const std::string before = end_run("2026-02-01").at("due.ics");
  EXPECT_NE(before.find("20260705"), std::string::npos) << before;
  store({.id = "bad", .day = "2026-05-05", .status = "failed", .manifest_read = true}, "r2");
  Said after = end_run("2026-06-01");
  EXPECT_NE(after["due.ics"].find("20260705"), std::string::npos) << after["due.ics"];
  EXPECT_EQ(after["due.ics"].find("20261105"), std::string::npos) << after["due.ics"];
}

/// Any damaged byte of the file: the output of the run is the same, and the next run uses the file
/// again.
TEST_F(KeptMachinesTest, DamagedTheyChangeNoByte) {
  constexpr std::uint64_t seed = 1926;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int k = 0; k < 12; ++k)
    store({.id = "c" + std::to_string(k),
           .day = "202" + std::to_string(k / 2) + "-0" + std::to_string(1 + k % 2) + "-15",
           .asset = k % 2 == 0 ? "S-0" : "S-1"},
          "r" + std::to_string(k));
  end_run("2026-01-01");
  const Said whole = end_run("2026-01-02");
  const fs::path path = out_.root() / ".nonio" / "machines.sqlite";
  const std::string bytes = read(path);
  for (int k = 0; k < 20; ++k) {
    std::string spoiled = bytes;
    const std::size_t at = k < 8 ? static_cast<std::size_t>(k) * 13 : random() % bytes.size();
    spoiled[at] = static_cast<char>(random());
    if (k % 10 == 9) spoiled.resize(at);
    Output::write(path, spoiled);
    EXPECT_EQ(make(out_.root(), "2026-01-02").at("json"), whole.at("json")) << at;
    EXPECT_EQ(make(out_.root(), "2026-01-02"), make(out_.root(), "2026-01-02")) << at;
  }
}

TEST_F(KeptMachinesTest, AreUsed) {
  for (int k = 0; k < 12; ++k)
    store({.id = "c" + std::to_string(k),
           .day = "202" + std::to_string(k / 2) + "-0" + std::to_string(1 + k % 2) + "-15",
           .asset = k % 2 == 0 ? "S-0" : "S-1"},
          "r" + std::to_string(k));
  end_run("2026-01-01");
  end_run("2026-01-02");  // campaigns of the last run are no longer reported as new
  const fs::path page = out_.root() / "machines" / "S-0.html";
  const auto written = fs::last_write_time(page);
  // A machine of which nothing is new is not read: the store may have lost its numbers.
  ask(out_.root(), "DROP TRIGGER result_no_DELETE");
  ask(out_.root(),
      "DELETE FROM result WHERE evaluation IN (SELECT evaluation FROM point WHERE "
      "machine = 'S-0')");
  const std::string before = read(page);
  make(out_.root(), "2026-01-03");
  EXPECT_EQ(read(page), before);
  EXPECT_EQ(fs::last_write_time(page), written);
  fs::remove(out_.root() / ".nonio" / "machines.sqlite");
  make(out_.root(), "2026-01-03");
  EXPECT_NE(read(page), before);
}

}  // namespace
}  // namespace nonio::test::kept_test
