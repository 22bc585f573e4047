// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/machines.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "campaign/evaluation/evaluate.h"
#include "methods.h"

namespace nonio::machines_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* whole_record = R"(format = 1
asset = "S-1"
maker = "Rossi"
serial = "0417"
control = "fanuc"
taken = ["0", "100-227"]

[axes.Z]
number = 3
reference_mm = 500.0
travel = [0.0, 800.0]
largest_um = 100.0
slope_um_per_m = 200.0
table = "none"
backlash_mm = 0.012
since = 2026-05-01

[axes.C]
number = 4
reference_deg = 0.0
backlash_deg = "none"
since = 2026-05-01
)";

template <class T>
std::string errors_of(const config::Checked<T>& record) {
  std::string all;
  if (!record)
    for (const Error& e : record.error())
      all += e.file + ":" + std::to_string(e.line) + ": " + e.message + "\n";
  return all;
}

config::MachineRecord record_from(const std::string& text) {
  auto record = config::parse_machine(text, "machines/S-1.toml", "S-1");
  EXPECT_TRUE(record) << errors_of(record);
  return record.value_or(config::MachineRecord{});
}

config::Manifest manifest_with(const std::string& more,
                               const std::string& machine = "asset = \"S-1\"") {
  auto manifest = config::parse_manifest(
      "format = 1\n[campaign]\nid = \"c\"\ndate = 2026-06-01\n[machine]\n" + machine +
          "\n[[measurement]]\nid = \"Z\"\nkind = \"axis\"\naxis = \"Z\"\nfile = \"z.csv\"\n" + more,
      "campaign.toml", own_methods());
  EXPECT_TRUE(manifest) << manifest.error().front().message;
  return manifest.value_or(config::Manifest{});
}

Info control_named(const char* name) {
  return {name,
          "1",
          "A control.",
          {{"axes", NumberTables{}, "", "Axes."},
           {"taken", std::vector<std::string>{}, "", "Numbers in use."}}};
}

using Texts = std::vector<std::string>;

config::RawOptions site_axes(const Texts& axes) {
  return {{"fanuc", {{"axes", config::RawOption{Setting(axes), "site.toml", 3}}}}};
}

TEST(Machines, ARecordIsRead) {
  const config::MachineRecord r = record_from(whole_record);
  EXPECT_EQ(r.control, "fanuc");
  EXPECT_EQ(r.axes.at("Z").settings.at("number"), 3.0);
  ASSERT_EQ(r.axes.at("Z").states.size(), 1U);
  EXPECT_EQ(r.axes.at("Z").states[0].table, "");
  EXPECT_DOUBLE_EQ(*r.axes.at("Z").states[0].backlash, 12e-6);
  EXPECT_TRUE(r.axes.at("C").rotary);
  EXPECT_EQ(r.axes.at("C").states.at(0).backlash, 0.0);
  EXPECT_FALSE(r.axes.at("C").states.at(0).table);
}

TEST(Machines, EachDayHasItsState) {
  const config::MachineRecord r = record_from(
      "format = 1\nasset = \"S-1\"\n[axes.X]\ntable = \"c.ini\"\nsince = 2026-05-01\n"
      "[[axes.X.state]]\nsince = 2024-01-10\ntable = \"a.ini\"\nbacklash_mm = 0.01\n"
      "source = \"backup\"\n"
      "[[axes.X.state]]\nsince = 2025-01-10\ntable = \"none\"\nbacklash_mm = \"none\"\n");
  const config::RecordedAxis& x = r.axes.at("X");
  const auto table_on = [&](const char* day) {
    const config::ControlState* s = x.state_on(day);
    return s == nullptr ? "unknown" : *s->table;
  };
  EXPECT_EQ(table_on("2024-01-09"), "unknown");
  EXPECT_EQ(table_on("2024-01-10"), "a.ini");  // it was read from the control on that day
  EXPECT_EQ(table_on("2025-01-10"), "a.ini");  // loaded on that day: before or after it?
  EXPECT_EQ(table_on("2025-01-11"), "");
  EXPECT_EQ(table_on("2026-05-01"), "");
  EXPECT_EQ(table_on("2026-05-02"), "c.ini");
  EXPECT_EQ(x.states.front().line_of_table, 8U);
  const auto wrong = [](const std::string& text) {
    return errors_of(config::parse_machine("format = 1\nasset = \"S-1\"\n[[axes.X.state]]\n" + text,
                                           "machines/S-1.toml", "S-1"));
  };
  EXPECT_NE(wrong("table = \"a\"").find("since: is missing"), std::string::npos)
      << wrong("table = \"a\"");
  EXPECT_NE(wrong("since = 2024-01-01\nsource = \"me\"").find("source"), std::string::npos);
  EXPECT_NE(wrong("since = 2024-01-01\nbacklash_deg = 0.1").find("axis X is linear"),
            std::string::npos);
}

TEST(Machines, MistakesAreNamedWithTheirLine) {
  const auto wrong = [](const std::string& text) {
    return errors_of(config::parse_machine("format = 1\n" + text, "machines/S-1.toml", "S-1"));
  };
  EXPECT_NE(wrong("asset = \"S-2\"").find("machines/S-1.toml:2: asset: expected \"S-1\""),
            std::string::npos);
  EXPECT_NE(wrong("asset = \"a/b\"").find(":2: asset: expected up to 100"), std::string::npos);
  EXPECT_NE(wrong("maker = \"x\"").find("asset: is missing"), std::string::npos);
  EXPECT_NE(wrong("asset = \"S-1\"\n[axes.X]\nnumbre = 1").find(":4: unknown key axes.X.numbre"),
            std::string::npos);
  EXPECT_NE(wrong("asset = \"S-1\"\n[axes.X]\nreference_deg = 1").find("unknown key"),
            std::string::npos);
  EXPECT_NE(wrong("asset = \"S-1\"\n[axes.X]\ntable = \"none\"").find("axes.X.since: is missing"),
            std::string::npos);
  EXPECT_NE(
      wrong("asset = \"S-1\"\n[axes.X]\nnumber = 1\n[axes.Y]\nnumber = 1").find("X and Y both"),
      std::string::npos);
  EXPECT_NE(wrong("asset = \"S-1\"\ntaken = [\"9-2\"]").find(":3: taken: expected numbers"),
            std::string::npos);
  EXPECT_NE(wrong("asset = \"S-1\"\n[axes.X]\nbacklash_mm = \"no\"\nsince = 2026-01-01")
                .find("or \"none\""),
            std::string::npos);
}

TEST(Machines, OptionAxesHasSiteThenRecordThenCampaign) {
  const config::MachineRecord r = record_from(whole_record);
  const config::Manifest m = manifest_with("[options.fanuc]\naxes = [\"Z step_mm=25\"]\n");
  const auto settled = config::settle_table_options(
      control_named("fanuc"), site_axes({"Z number=9 step_mm=50 drifted=1", "Q number=7"}), m, &r);
  ASSERT_TRUE(settled);
  const NumberTables expected{{"Z",
                               {{"number", 3},
                                {"step_mm", 25},
                                {"drifted", 1},
                                {"from_mm", 0},
                                {"largest_um", 100},
                                {"reference_mm", 500},
                                {"slope_um_per_m", 200},
                                {"to_mm", 800}}}};
  EXPECT_EQ(settled->tables("axes"), expected);
  EXPECT_EQ(settled->texts("taken"), Texts({"0", "100-227"}));
}

// The same axes, written as tables and as texts.
TEST(Machines, TablesAndTextsOfAxesAreTheSame) {
  const config::MachineRecord r = record_from(whole_record);
  const config::Manifest tables =
      manifest_with("[options.fanuc.axes.Z]\nstep_mm = 25\n[options.fanuc.axes.X]\nnumber = 1\n");
  const config::Manifest texts =
      manifest_with("[options.fanuc]\naxes = [\"Z step_mm=25\", \"X number=1\"]\n");
  const auto one = config::settle_table_options(control_named("fanuc"), {}, tables, &r);
  const auto two = config::settle_table_options(control_named("fanuc"), {}, texts, &r);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->tables("axes"), two->tables("axes"));
  EXPECT_EQ(one->tables("axes").at("X").at("number"), 1.0);
}

// A key of a table has a line of its own.
TEST(Machines, AMistakeInATableOfAnAxisHasItsLine) {
  const config::MachineRecord r = record_from(whole_record);
  const config::Manifest m = manifest_with("[options.fanuc.axes.Z]\nstep_mm = 25\n\nnumber = 1\n");
  const auto settled = config::settle_table_options(control_named("fanuc"), {}, m, &r);
  ASSERT_FALSE(settled);
  EXPECT_EQ(settled.error().front().line, 15U) << settled.error().front().message;
  const std::string found = errors_of(
      config::parse_manifest("format = 1\n[options.fanuc.axes.Z]\nstep_mm = 25\nnumber = \"1\"\n",
                             "campaign.toml", own_methods()));
  EXPECT_NE(found.find("campaign.toml:4: options.fanuc.axes.Z.number: expected a finite number"),
            std::string::npos)
      << found;
}

TEST(Machines, WhatIsNoNumberInATextOfAnAxisIsRefused) {
  for (const char* entry :
       {"X step_mm", "X step_mm=", "X step_mm=5,5", "X step_mm=nan", "X step_mm=1e999"}) {
    const auto tables = config::number_tables_of({entry});
    ASSERT_FALSE(tables) << entry;
    EXPECT_NE(tables.error().message.find("expected step_mm=NUMBER"), std::string::npos) << entry;
  }
  EXPECT_FALSE(config::number_tables_of({""}));
  EXPECT_EQ(config::number_tables_of({"X number=3 number=4"}).error().message,
            "axis X has number=3 and number=4: which of them?");
}

TEST(Machines, ARecordIsOfItsControlOnly) {
  const config::MachineRecord r = record_from(whole_record);
  const config::Manifest m = manifest_with("");
  const auto settled = config::settle_table_options(control_named("pmac"), {}, m, &r);
  ASSERT_TRUE(settled);
  EXPECT_EQ(settled->tables("axes"), NumberTables());
  std::string text = whole_record;
  text.erase(text.find("control = \"fanuc\"\n"), 18);
  const config::MachineRecord any = record_from(text);
  EXPECT_EQ(config::settle_table_options(control_named("pmac"), {}, m, &any)->tables("axes").size(),
            1U);
}

TEST(Machines, ACampaignThatContradictsTheRecordIsRefused) {
  const config::MachineRecord r = record_from(whole_record);
  const config::Manifest m = manifest_with("[options.fanuc]\naxes = [\"Z number=1\"]\n");
  const auto settled = config::settle_table_options(control_named("fanuc"), {}, m, &r);
  ASSERT_FALSE(settled);
  EXPECT_EQ(settled.error().front().file, "campaign.toml");
  EXPECT_EQ(settled.error().front().line, 13U);
  EXPECT_NE(settled.error().front().message.find("number=1 contradicts machines/S-1.toml:9"),
            std::string::npos)
      << settled.error().front().message;

  const auto two = config::contradictions(
      manifest_with("",
                    "asset = \"S-1\"\nserial = \"9\"\ncontrol = \"pmac\"\n[machine.axes.Z]\n"
                    "travel = [0, 700]"),
      r);
  ASSERT_EQ(two.size(), 3U);
  EXPECT_EQ(two[0].line, 7U);
  EXPECT_EQ(two[0].message,
            "machine.serial: \"9\" contradicts machines/S-1.toml:4, where it is "
            "\"0417\"");
  EXPECT_NE(two[1].message.find("machine.control"), std::string::npos);
  EXPECT_EQ(two[2].message,
            "machine.axes.Z.travel: \"0 to 700\" contradicts machines/S-1.toml:11, "
            "where it is \"0 to 800\"");
  EXPECT_TRUE(config::contradictions(manifest_with(""), r).empty());
}

TEST(Machines, WhatWasOnWhileMeasuredIsTheBacklashThen) {
  const config::Manifest m = manifest_with("[machine.axes.Z]\nactive_backlash_mm = 0.02\n");
  EXPECT_EQ(config::settle_table_options(control_named("fanuc"), {}, m, nullptr)->tables("axes"),
            (NumberTables{{"Z", {{"backlash_mm", 0.02}}}}));
  const config::Manifest other = manifest_with(
      "[machine.axes.Z]\nactive_backlash_mm = 0.02\n[options.fanuc]\naxes = [\"Z "
      "backlash_mm=0.01\"]\n");
  EXPECT_FALSE(config::settle_table_options(control_named("fanuc"), {}, other, nullptr));
}

class MachinesFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "nonio-machines-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    site_ = name;
    fs::create_directories(site_ / "machines");
  }
  void TearDown() override { fs::remove_all(site_); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((site_ / name).parent_path());
    std::ofstream(site_ / name) << text;
  }
  fs::path site_;
};

TEST_F(MachinesFolder, AMachineIsFoundByAssetElseByMakerAndSerial) {
  write("machines/S-1.toml", whole_record);
  write("machines/S-2.toml", "format = 1\nasset = \"S-2\"\nmaker = \"Rossi\"\nserial = \"2\"\n");
  write("machines/broken.toml", "format = ");
  const auto all = config::read_machines(site_);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 3U);
  const auto found = [&](const Machine& m) {
    const auto one = config::record_of(*all, m);
    return !one ? one.error().message : *one == nullptr ? "none" : (*one)->asset;
  };
  Machine m;
  EXPECT_EQ(found(m), "none");
  EXPECT_EQ(config::machine_input(m), "");
  m.maker = "Rossi", m.serial = "2";
  EXPECT_EQ(found(m), "S-2");
  EXPECT_EQ(config::machine_digest(*all, config::machine_input(m)), (*all)[1].sha256);
  m.asset = "S-1";
  EXPECT_EQ(found(m), "S-1");
  m.asset = "S-3";
  EXPECT_EQ(found(m), "none");
  EXPECT_EQ(config::machine_digest(*all, config::machine_input(m)), config::absent);
  m.asset = "broken";
  EXPECT_EQ(found(m), "broken");
  write("machines/S-4.toml", "format = 1\nasset = \"S-4\"\nmaker = \"Rossi\"\nserial = \"2\"\n");
  m.asset.clear();
  const auto two = config::read_machines(site_);
  EXPECT_FALSE(config::record_of(*two, m));
  EXPECT_NE(config::machine_digest(*two, config::machine_input(m)), (*all)[1].sha256);
}

TEST_F(MachinesFolder, AFileThatChangesIsNoLongerTheStateThatWasRecorded) {
  write("x.ini", "a");
  const std::string sha = config::table_sha256({{"any", "a"}});
  write("machines/S-1.toml",
        "format = 1\nasset = \"S-1\"\n[[axes.X.state]]\nsince = 2026-01-01\n"
        "table = \"x.ini\"\nsha256 = \"" +
            sha + "\"\n");
  auto all = config::read_machines(site_);
  ASSERT_TRUE((*all)[0].record) << errors_of((*all)[0].record);
  EXPECT_EQ((*all)[0].tables.at("X x.ini").at(0).bytes, "a");
  const auto back = config::unpacked_record(config::packed((*all)[0]));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sha256, (*all)[0].sha256);
  write("x.ini", "b");
  all = config::read_machines(site_);
  EXPECT_NE(errors_of((*all)[0].record).find("S-1.toml:5: axes.X.state.sha256: x.ini has changed"),
            std::string::npos)
      << errors_of((*all)[0].record);
}

TEST_F(MachinesFolder, NothingIsReadFromOutsideOfTheSite) {
  const std::string head = "format = 1\nasset = \"S-1\"\n[axes.X]\nsince = 2026-01-01\ntable = ";
  write("machines/S-1.toml", head + "\"../../etc/passwd\"\n");
  auto all = config::read_machines(site_);
  ASSERT_TRUE(all);
  EXPECT_NE(errors_of((*all)[0].record).find("machines/S-1.toml:5: axes.X.table"),
            std::string::npos)
      << errors_of((*all)[0].record);
  write("machines/S-1.toml", head + "\"backup/x.ini\"\n");
  write("backup/x.ini", "a");
  all = config::read_machines(site_);
  ASSERT_TRUE((*all)[0].record) << errors_of((*all)[0].record);
  EXPECT_EQ((*all)[0].tables.at("X").at(0).bytes, "a");
  const std::string before = (*all)[0].sha256;
  const auto back = config::unpacked_record(config::packed((*all)[0]));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sha256, before);
  write("backup/x.ini", "b");
  EXPECT_NE((*config::read_machines(site_))[0].sha256, before);
  fs::remove(site_ / "machines/S-1.toml");
  fs::create_symlink("/etc/hostname", site_ / "machines/S-1.toml");
  EXPECT_FALSE((*config::read_machines(site_))[0].record);
  write("machines/big.toml", std::string(1'100'000, '#'));
  all = config::read_machines(site_);
  EXPECT_NE(errors_of((*all)[1].record).find("at most 1 MB"), std::string::npos);
}

}  // namespace
}  // namespace nonio::machines_test
