// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "csv.h"

namespace nonio::csv::comments_test {
namespace {

struct Doubt {
  std::string id, found, expected, where;
};

std::vector<Doubt> doubts(const std::string& text, const std::string& axis = "X",
                          const std::string& kind = "axis", const std::string& lateral = "") {
  Campaign campaign;
  for (const char* name : {"X", "Y", "C"}) {
    Axis a;
    a.name = name;
    a.rotary = a.name == "C";
    campaign.machine.axes.push_back(a);
  }
  campaign.machine.axes[1].slave = "Y2";
  Measurement m;
  m.id = "m1";
  m.kind = kind;
  m.axis = axis;
  m.lateral = lateral;
  m.file = "m1.csv";
  if (axis == "Y") m.side = "slave";
  const Settings options;
  std::string bytes = text;  // like the host's: what is reported as done is overwritten
  const auto obs = read({bytes, campaign, m, options,
                         [&bytes](std::size_t done) { std::fill_n(bytes.begin(), done, '#'); }});
  EXPECT_TRUE(obs) << obs.error().message;
  std::vector<Doubt> out;
  if (!obs) return out;
  for (const Finding& f : obs->doubts) {
    EXPECT_TRUE(f.attention);
    Doubt& d = out.emplace_back(Doubt{f.id, "", "", ""});
    for (const auto& [name, value] : f.texts)
      (name == "found" ? d.found : name == "expected" ? d.expected : d.where) = value;
  }
  return out;
}

std::string with(const std::string& comment,
                 const std::string& columns = "target_mm,deviation_um") {
  return "# " + comment + "\nrun,direction," + columns + "\n1,+,0,1\n1,+,10,2\n";
}

struct Wrong {
  std::string comment, found, expected;
  std::string columns = "target_mm,deviation_um";
};

TEST(Comments, AUnitThatIsNotTheColumnsIsDoubted) {
  for (const Wrong& w :
       std::vector<Wrong>{{"deviations in nm", "nm", "deviation_um"},
                          {"Deviations are given in Nanometer", "nm", "deviation_um"},
                          {"Abweichung [mm]", "mm", "deviation_um"},
                          {"Alle Abweichungen in mm", "mm", "deviation_um"},
                          {"scostamenti: pollici", "inch", "deviation_um"},
                          {"desviaciones en mm", "mm", "deviation_um"},
                          {"偏差: nm", "nm", "deviation_um"},
                          {"errors (mil)", "mil", "deviation_um"},
                          {"Units: inch", "inch", "deviation_um"},
                          {"Einheit = nm", "nm", "deviation_um"},
                          {"unit: m", "m", "deviation_um"},
                          {"target: m", "m", "target_mm"},
                          {"target [in]", "inch", "target_mm"},
                          {"Sollposition in cm; Abweichung in um", "cm", "target_mm"},
                          {"run,direction,target_inch,deviation_um", "inch", "target_mm"},
                          {"run;direction;target_mm;deviation_nm", "nm", "deviation_um"},
                          {"unit: inch", "inch", "target_mm", "target_mm,position_mm"},
                          {"positions in um", "um", "target_mm", "target_mm,position_mm"}}) {
    const auto found = doubts(with(w.comment, w.columns));
    ASSERT_EQ(found.size(), 1U) << w.comment;
    EXPECT_EQ(found[0].id, "plausibility.comment-unit") << w.comment;
    EXPECT_EQ(found[0].found, w.found) << w.comment;
    EXPECT_EQ(found[0].expected, w.expected) << w.comment;
    EXPECT_EQ(found[0].where, "m1.csv:1") << w.comment;
  }
}

// What is about something else, or right.
TEST(Comments, NothingElseIsDoubted) {
  for (const char* comment : {"deviations in um, targets in mm",
                              "Deviation [µm]",
                              "units: mm",
                              "unit: um",
                              "resolution 1 nm",
                              "error limit 5 nm",
                              "deviation below 3 nm of noise",
                              "Einheit: °C",
                              "air temperature unit: deg C",
                              "unit: hPa",
                              "measured in M. Rossi's shop",
                              "deviation m",
                              "error in M code 6",
                              "target in 3 m distance",
                              "laser, 12 January, travel 1 m",
                              "axis: X",
                              "axis: X and Y",
                              "axis X beside Y",
                              "axis: Y at 500 mm",
                              "Achse: Z4711",
                              "target 5 in",
                              "1 unit = 1 nm",
                              "a\tb\tc [m]",
                              "Pr\374fung in mm"})
    EXPECT_TRUE(doubts(with(comment)).empty()) << comment;
  EXPECT_TRUE(doubts(with("deviations in mm", "target_mm,position_mm")).empty());
}

TEST(Comments, TheFootCountsTooAndLongFilesAreNotReadTwice) {
  std::string text = "run,direction,target_mm,deviation_um\n";
  for (int i = 0; i < 30000; ++i) text += "1,+," + std::to_string(i) + ",0.5\n";
  EXPECT_TRUE(doubts(text).empty());
  const auto found = doubts(text + "# deviations in nm\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].where, "m1.csv:30002");
}

TEST(Comments, OfAFileWhosePagesAreGivenBackWhileItIsReadAreFoundWithTheirLine) {
  std::string text = "# deviations in um\nrun,direction,target_mm,deviation_um\n";
  for (int i = 0; i < 400000; ++i) text += "1,+," + std::to_string(i) + ",0.5\n";
  ASSERT_GT(text.size(), std::size_t{5} << 20U);  // CSV reports every 4 MiB
  EXPECT_TRUE(doubts(text).empty());
  const auto found = doubts(text + "# deviations in nm\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].where, "m1.csv:400003");
  EXPECT_EQ(doubts("# deviations in nm\n" + text)[0].where, "m1.csv:1");
}

TEST(Comments, AnotherAxisOfTheMachineIsDoubted) {
  for (const auto& [comment, axis, name] : {std::tuple("axis: Y", "X", "Y"),
                                            {"Achse = y", "X", "Y"},
                                            {"asse: Y2", "X", "Y2"},
                                            {"eje: X", "Y", "X"},
                                            {"axis: Y1", "Y", "Y1"}}) {
    const auto found = doubts(with(comment), axis);
    ASSERT_EQ(found.size(), 1U) << comment;
    EXPECT_EQ(found[0].id, "plausibility.name-of-another");
    EXPECT_EQ(found[0].found, name);
    EXPECT_EQ(found[0].expected, std::string(axis) == "Y" ? "Y2" : "X");
  }
  EXPECT_TRUE(doubts(with("axis: Y2"), "Y").empty());
  EXPECT_TRUE(doubts(with("axis: Y"), "Y").empty());
  EXPECT_TRUE(doubts(with("axis: Y"), "X", "straightness", "Y").empty());
}

}  // namespace
}  // namespace nonio::csv::comments_test
