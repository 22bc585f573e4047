// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "csv.h"

namespace nonio::csv::csv_reader_test {
namespace {

using namespace std::string_literals;

Expected<Observations> read_text(const std::string& text, const std::string& kind = "axis",
                                 const std::string& axis = "X", const std::string& lateral = "",
                                 std::function<void(std::size_t)> done_with = {}) {
  Campaign campaign;
  for (const char* name : {"X", "Y", "Z", "C"}) {
    Axis a;
    a.name = name;
    a.rotary = a.name == "C";
    campaign.machine.axes.push_back(a);
  }
  Measurement m;
  m.id = "m1";
  m.kind = kind;
  m.axis = axis;
  m.lateral = lateral;
  m.file = "m1.csv";
  const Settings options;
  return read({text, campaign, m, options, std::move(done_with)});
}

const std::string head = "run,direction,target_mm,deviation_um\n";

/// What is to be read: run, direction, target in mm, deviation in um.
struct Reading {
  unsigned run;
  int approach;
  double target_mm, deviation_um;
};

struct GoodCase {
  std::string name, text;
  std::vector<Reading> readings;
  std::uint64_t missing = 0;
  std::size_t notes = 0;
};

void PrintTo(const GoodCase& c, std::ostream* os) { *os << c.name; }

class Good : public testing::TestWithParam<GoodCase> {};

TEST_P(Good, GivesTheReadingsThatItHolds) {
  const GoodCase& c = GetParam();
  const auto obs = read_text(c.text);
  ASSERT_TRUE(obs) << obs.error().message << " line " << obs.error().line;
  EXPECT_EQ(obs->missing, c.missing);
  EXPECT_EQ(obs->notes.size(), c.notes);
  ASSERT_EQ(obs->size(), c.readings.size());
  for (std::size_t i = 0; i < c.readings.size(); ++i) {
    EXPECT_EQ(obs->run[i], c.readings[i].run) << i;
    EXPECT_EQ(obs->axes[0].approach[i], c.readings[i].approach) << i;
    EXPECT_EQ(obs->axes[0].position[i], c.readings[i].target_mm / 1e3) << i;
    EXPECT_EQ(obs->deviation[i], c.readings[i].deviation_um / 1e6) << i;
  }
}

const std::vector<Reading> two = {{1, 1, 100.25, -1.5}, {1, -1, 100.25, 2.0}};

const GoodCase good_cases[] = {
    {"comma", head + "1,+,100.25,-1.5\n1,-,100.25,2\n", two},
    {"semicolon", "run;direction;target_mm;deviation_um\n1;+;100.25;-1.5\n1;-;100.25;2\n", two},
    {"tab", "run\tdirection\ttarget_mm\tdeviation_um\n1\t+\t100.25\t-1.5\n1\t-\t100.25\t2\n", two},
    {"decimal comma with semicolon",
     "run;direction;target_mm;deviation_um\n1;+;100,25;-1,5\n1;-;100,25;2\n", two},
    {"decimal comma with tab",
     "run\tdirection\ttarget_mm\tdeviation_um\n1\t+\t100,25\t-1,5\n1\t-\t100,25\t2,0\n", two},
    {"byte order mark", "\xEF\xBB\xBF" + head + "1,+,100.25,-1.5\n1,-,100.25,2\n", two},
    {"Excel's sep=",
     "sep=;\r\nrun;direction;target_mm;deviation_um\r\n1;+;100,25;-1,5\r\n1;-;100,25;2\r\n", two},
    {"Excel's sep= in quotes, with a byte order mark",
     "\xEF\xBB\xBF\"sep=\t\"\nrun\tdirection\ttarget_mm\tdeviation_um\n1\t+\t100.25\t-1.5\n1\t-"
     "\t100.25\t2\n",
     two},
    {"Latin-1 in a comment", "# per\xF2\n" + head + "1,+,100.25,-1.5\n#\xB5m\n1,-,100.25,2\n", two},
    {"CRLF", "run,direction,target_mm,deviation_um\r\n1,+,100.25,-1.5\r\n1,-,100.25,2\r\n", two},
    {"no end of the last line", head + "1,+,100.25,-1.5\n1,-,100.25,2", two},
    {"lone CR at the end", head + "1,+,100.25,-1.5\n1,-,100.25,2\r", two},
    {"comments and blank lines",
     "# made up\n\n" + head + "  # indented, per\xC3\xB2\n1,+,100.25,-1.5\n\n \t\n1,-,100.25,2\n#",
     two},
    {"trimmed names and fields",
     " run , direction,target_mm ,deviation_um\n 1 , + , 100.25 , -1.5 \n1,-,100.25,2\n", two},
    {"quoted fields",
     "\"run\",\"direction\",\"target_mm\",\"deviation_um\"\n\"1\",\"+\",\"100.25\",\"-1.5\"\n1,-,"
     "100.25,2\n",
     two},
    {"other order of columns",
     "deviation_um,target_mm,direction,run\n-1.5,100.25,+,1\n2,100.25,-,1\n", two},
    {"positions",
     "run,direction,target_mm,position_mm\n1,+,100.25,100.2485\n1,-,100.25,100.252\n",
     {{1, 1, 100.25, (100.2485 - 100.25) * 1e3}, {1, -1, 100.25, (100.252 - 100.25) * 1e3}}},
    {"plus sign and exponent", head + "1,+,1.0025e2,-15e-1\n1,-,+100.25,+2\n", two},
    {"rows of separators", head + "1,+,100.25,-1.5\n,,,\n1,-,100.25,2\n , ,,\n", two, 0, 1},
    {"largest run", head + "4294967295,+,1,1\n", {{4294967295U, 1, 1, 1}}},
    {"zero is a reading", head + "1,+,1,0\n1,-,1,-0.0\n", {{1, 1, 1, 0}, {1, -1, 1, 0}}},
    {"blank is missing", head + "1,+,1,\n1,-,1,2\n", {{1, -1, 1, 2}}, 1},
    {"marks of missing readings",
     head + "1,+,1,nan\n2,+,1,N/"
            "A\n3,+,1,inf\n4,+,1,-INF\n5,+,1,1e19\n6,+,1,-1e20\n7,+,1,NaN\n1,-,1,2\n",
     {{1, -1, 1, 2}},
     7},
    {"just below the mark", head + "1,+,1,9.9e18\n", {{1, 1, 1, 9.9e18}}},
    {"missing position",
     "run,direction,target_mm,position_mm\n1,+,1,-1e20\n1,-,1,1\n",
     {{1, -1, 1, 0}},
     1},
    {"identical rows",
     head + "1,+,100.25,-1.5\n1,-,100.25,2\n1,+,100.250,-1.50\n1,-,100.25,2\n1,+,100.25,-1.5\n",
     two, 0, 1},
    {"identical rows in sequence", head + "1,+,100.25,-1.5\n1,+,100.25,-1.5\n1,-,100.25,2\n", two,
     0, 1},
    {"one missing and one taken",
     head + "1,+,100.25,nan\n1,+,100.25,-1.5\n1,-,100.25,2\n1,-,100.25,\n", two},
    {"missing twice is missing once",
     head + "1,+,1,nan\n1,+,1,\n1,+,2,3\n1,+,2,3\n",
     {{1, 1, 2, 3}},
     1,
     1},
    {"targets of the directions differ",
     head + "1,+,15,1\n1,-,15.2,2\n",
     {{1, 1, 15, 1}, {1, -1, 15.2, 2}}},
    {"step cycle",
     head + "1,+,1,1\n2,+,1,2\n1,+,2,3\n2,+,2,4\n",
     {{1, 1, 1, 1}, {2, 1, 1, 2}, {1, 1, 2, 3}, {2, 1, 2, 4}}},
    {"a pass that turns back",
     head + "1,+,1,1\n1,+,3,2\n1,+,2,3\n",
     {{1, 1, 1, 1}, {1, 1, 3, 2}, {1, 1, 2, 3}}},
};
INSTANTIATE_TEST_SUITE_P(Csv, Good, testing::ValuesIn(good_cases));

struct BadCase {
  std::string name, text;
  std::uint64_t line;
  std::string column;
  std::vector<std::string> says;  ///< parts of the message
  std::string axis = "X", kind = "axis", lateral{};
};

void PrintTo(const BadCase& c, std::ostream* os) { *os << c.name; }

class Bad : public testing::TestWithParam<BadCase> {};

TEST_P(Bad, IsRefusedWithItsPlace) {
  const BadCase& c = GetParam();
  const auto obs = read_text(c.text, c.kind, c.axis, c.lateral);
  ASSERT_FALSE(obs);
  EXPECT_EQ(obs.error().file, "m1.csv");
  EXPECT_EQ(obs.error().line, c.line) << obs.error().message;
  EXPECT_EQ(obs.error().column, c.column) << obs.error().message;
  for (const std::string& part : c.says)
    EXPECT_NE(obs.error().message.find(part), std::string::npos)
        << "expected: " << part << "\nfound: " << obs.error().message;
}

const std::string semi = "run;direction;target_mm;deviation_um\n";
const std::string utf16 = "\xFF\xFEr\0u\0n\0,\0"s;

std::string ten_million(char c, std::size_t times = 10000000) { return std::string(times, c); }

const BadCase bad_cases[] = {
    {"empty file", "", 0, "", {"header row", "empty file"}},
    {"only a mark", "\xEF\xBB\xBF", 0, "", {"empty file"}},
    {"only comments", "# a\n\n", 2, "", {"empty file"}},
    {"only a header", head, 0, "", {"only a header row"}},
    {"nothing taken", head + "1,+,1,nan\n1,-,1,\n", 0, "", {"2", "not one was taken"}},
    {"no header", "1,+,1,2\n", 1, "", {"header row", "number \"1\""}},
    {"unknown column",
     "run,direction,targt_mm,deviation_um\n1,+,1,2\n",
     1,
     "targt_mm",
     {"unknown column \"targt_mm\"", "did you mean \"target_mm\""}},
    {"unknown unit",
     "run,direction,target_mm,deviation_mm\n1,+,1,2\n",
     1,
     "deviation_mm",
     {"deviation_um"}},
    {"name in capitals", "Run,direction,target_mm,deviation_um\n1,+,1,2\n", 1, "Run", {"\"run\""}},
    {"column without a name",
     "run,direction,target_mm,deviation_um,\n1,+,1,2,\n",
     1,
     "",
     {"column 5", "no name"}},
    {"column twice", "run,direction,run,target_mm,deviation_um\n", 1, "run", {"occurs twice"}},
    {"deviation and position",
     "run,direction,target_mm,deviation_um,position_mm\n1,+,1,0,1\n",
     1,
     "position_mm",
     {"deviation_um", "position_mm", "only one"}},
    {"no run", "direction,target_mm,deviation_um\n+,1,2\n", 1, "", {"missing column", "\"run\""}},
    {"no direction",
     "run,target_mm,deviation_um\n1,1,2\n",
     1,
     "",
     {"missing column", "\"direction\""}},
    {"no target",
     "run,direction,deviation_um\n1,+,2\n",
     1,
     "",
     {"missing column", "\"target_mm\""}},
    {"no reading",
     "run,direction,target_mm\n1,+,2\n",
     1,
     "",
     {"missing column", "\"deviation_um\"", "\"position_mm\""}},
    {"degrees on a linear axis",
     "run,direction,target_deg,deviation_arcsec\n1,+,1,2\n",
     1,
     "target_deg",
     {"wrong unit", "linear", "\"target_mm\""}},
    {"mm on a rotary axis",
     head + "1,+,1,2\n",
     1,
     "target_mm",
     {"wrong unit", "rotary", "\"target_deg\""},
     "C"},
    {"um on a rotary axis",
     "run,direction,target_deg,deviation_um\n1,+,1,2\n",
     1,
     "deviation_um",
     {"wrong unit", "\"deviation_arcsec\""},
     "C"},
    {"position_mm on a rotary axis",
     "run,direction,target_deg,position_mm\n1,+,1,2\n",
     1,
     "position_mm",
     {"wrong unit", "\"position_deg\""},
     "C"},
    {"arcsec in a straightness",
     "run,direction,target_mm,deviation_arcsec\n1,+,1,2\n",
     1,
     "deviation_arcsec",
     {"wrong unit", "straightness", "\"deviation_um\""},
     "X",
     "straightness",
     "Y"},
    {"position in a straightness",
     "run,direction,target_mm,position_mm\n1,+,1,2\n",
     1,
     "position_mm",
     {"straightness", "\"deviation_um\""},
     "X",
     "straightness",
     "Y"},
    {"run zero", head + "0,+,1,2\n", 2, "run", {"from 1 to 4294967295", "\"0\""}},
    {"run too large", head + "4294967296,+,1,2\n", 2, "run", {"4294967296"}},
    {"run blank", head + ",+,1,2\n", 2, "run", {"found \"\""}},
    {"run not whole", head + "1.5,+,1,2\n", 2, "run", {"1.5"}},
    {"direction blank", head + "1,,1,2\n", 2, "direction", {"+ or -", "\"\""}},
    {"direction in words", head + "1,up,1,2\n", 2, "direction", {"+ or -", "\"up\""}},
    {"target blank", head + "1,+,,2\n", 2, "target_mm", {"expected a target", "\"\""}},
    {"target nan", head + "1,+,nan,2\n", 2, "target_mm", {"expected a target", "nan"}},
    {"target 1e20", head + "1,+,1e20,2\n", 2, "target_mm", {"expected a target"}},
    {"letter for a digit",
     "# c\n" + head + "\n1,+,4O0.5,2\n",
     4,
     "target_mm",
     {"number", "\"4O0.5\""}},
    {"thousands and decimals", semi + "1;+;1.234,5;2\n", 2, "target_mm", {"1.234,5", "thousands"}},
    {"thousands with an apostrophe",
     semi + "1;+;1'234;2\n",
     2,
     "target_mm",
     {"1'234", "thousands"}},
    {"point among commas",
     semi + "1;+;100,5;2\n1;+;1.234;2\n",
     3,
     "target_mm",
     {"1.234", "decimal point", "decimal comma in line 2"}},
    {"comma among points",
     semi + "1;+;1.234;2\n1;+;2;2,5\n",
     3,
     "deviation_um",
     {"2,5", "decimal comma", "decimal point in line 2"}},
    {"trailing letters", head + "1,+,1,1e5x\n", 2, "deviation_um", {"1e5x"}},
    {"hexadecimal", head + "1,+,1,0x1A\n", 2, "deviation_um", {"0x1A"}},
    {"word for a reading", head + "1,+,1,none\n", 2, "deviation_um", {"none"}},
    {"word in time",
     "run,direction,target_mm,deviation_um,time_s\n1,+,1,2,noon\n",
     2,
     "time_s",
     {"noon"}},
    {"decimal comma between commas",
     head + "1,+,100,25,1\n",
     2,
     "",
     {"4 fields", "found 5", "decimal comma"}},
    {"quoted decimal comma between commas",
     head + "1,+,\"100,25\",1\n",
     2,
     "target_mm",
     {"decimal comma"}},
    {"too few fields", head + "1,+,100\n", 2, "", {"4 fields", "found 3"}},
    {"too many fields", semi + "1;+;100;2;3\n", 2, "", {"4 fields", "found 5"}},
    {"other separator in the rows", semi + "1,+,100,2\n", 2, "", {"4 fields", "found 1"}},
    {"quote not closed", head + "1,+,\"100,2\n", 2, "", {"quote"}},
    {"quote not closed in the header", "\"run,direction\n1,+\n", 1, "", {"quote"}},
    {"other value",
     head + "1,+,1,2\n1,-,1,3\n1,+,1,2.5\n",
     4,
     "",
     {"run 1", "direction +", "target 1 mm", "line 2"}},
    {"other value after repetition", head + "1,+,1,2\n1,+,1,2\n1,+,1,2.5\n", 4, "", {"line 2"}},
    {"other time",
     "run,direction,target_mm,deviation_um,time_s\n1,+,1,2,0\n1,+,1,2,5\n",
     3,
     "",
     {"line 2"}},
    {"time in one only",
     "run,direction,target_mm,deviation_um,time_s\n1,+,1,2,0\n1,+,1,2,\n",
     3,
     "",
     {"line 2"}},
    {"first contradiction of two",
     head + "1,+,9,2\n1,+,1,2\n1,+,1,3\n1,+,9,3\n",
     4,
     "",
     {"line 3"}},
    {"NUL in a field", head + "1,+,1,2\0\n"s, 2, "", {"NUL"}},
    {"NUL in a comment", "#\0\n"s + head + "1,+,1,2\n", 1, "", {"NUL"}},
    {"UTF-16", utf16, 1, "", {"NUL", "UTF-16"}},
    {"NUL in a comment", std::string("# \0\n", 4) + head + "1,+,1,2\n", 1, "", {"NUL"}},
    {"another separator than stated",
     "sep=;\n" + head + "1,+,1,2\n",
     2,
     "",
     {"\";\"", "sep=", "\",\""}},
    {"sep= that is not the first line", head + "sep=,\n", 2, "", {"expected 4 fields"}},
    {"Latin-1 in the header", "run,direction,target_mm,deviation_\xB5m\n", 1, "", {"UTF-8"}},
    {"Latin-1 in a field", head + "1,+,1,2\xB5\n", 2, "", {"UTF-8"}},
    {"minus of typographers", head + "1,\xE2\x88\x92,1,2\n", 2, "direction", {"\xE2\x88\x92"}},
    {"CR alone between lines",
     "run,direction,target_mm,deviation_um\r1,+,1,2\r",
     1,
     "",
     {"lone CR"}},
    {"line of 10 MB",
     head + "1,+,1," + ten_million('1') + "\n",
     2,
     "",
     {"at most 65536", "10000006"}},
    {"header of 10 MB", ten_million('r'), 1, "", {"at most 65536"}},
    {"comment of 10 MB", "#" + ten_million('r'), 1, "", {"at most 65536"}},
};
INSTANTIATE_TEST_SUITE_P(Csv, Bad, testing::ValuesIn(bad_cases));

TEST(Csv, ErrorsOfTheManifestBlameNoMeasurementFile) {
  for (const auto& obs :
       {read_text(head + "1,+,1,2\n", "straightness"), read_text(head + "1,+,1,2\n", "axis", "W"),
        read_text(head + "1,+,1,2\n", "axis", ""),
        read_text(head + "1,+,1,2\n", "straightness", "C", "Y")}) {
    ASSERT_FALSE(obs);
    EXPECT_EQ(obs.error().file, "");
    EXPECT_EQ(obs.error().line, 0U);
    EXPECT_NE(obs.error().message.find("expected"), std::string::npos) << obs.error().message;
  }
}

TEST(Csv, EnvironmentColumnsAreReadAndBlankIsNaN) {
  const auto obs = read_text(
      "run,direction,target_mm,deviation_um,time_s,material_c,air_c,pressure_hpa,humidity_pct\n"
      "1,+,1,2,0.5,20.1,21,1013.2,45\n"
      "1,+,2,2,,nan,1e20,n/a,inf\n"
      "1,+,3,nan,9,9,9,9,9\n");
  ASSERT_TRUE(obs);
  ASSERT_EQ(obs->size(), 2U);
  EXPECT_EQ(obs->time[0], 0.5);
  EXPECT_EQ(obs->material[0], 20.1);
  EXPECT_EQ(obs->air[0], 21.0);
  EXPECT_EQ(obs->pressure[0], 1013.2);
  EXPECT_EQ(obs->humidity[0], 45.0);
  for (const auto* column :
       {&obs->time, &obs->material, &obs->air, &obs->pressure, &obs->humidity}) {
    ASSERT_EQ(column->size(), 2U);
    EXPECT_TRUE(std::isnan((*column)[1]));
  }
}

TEST(Csv, ColumnsThatTheFileDoesNotHaveAreAbsent) {
  const auto obs = read_text(head + "1,+,1,2\n");
  ASSERT_TRUE(obs);
  EXPECT_TRUE(obs->time.empty());
  EXPECT_TRUE(obs->material.empty());
  EXPECT_TRUE(obs->air.empty());
  EXPECT_TRUE(obs->pressure.empty());
  EXPECT_TRUE(obs->humidity.empty());
  EXPECT_TRUE(obs->u.empty());
  EXPECT_TRUE(obs->line.empty());
}

TEST(Csv, AxisLineAndSourceLine) {
  const auto obs = read_text("# c\n" + head + "\n1,+,1,2\n1,-,1,3\n", "axis", "Y");
  ASSERT_TRUE(obs);
  EXPECT_EQ(obs->measurement, "m1");
  EXPECT_FALSE(obs->angular);
  ASSERT_EQ(obs->axes.size(), 1U);
  EXPECT_EQ(obs->axes[0].axis, "Y");
  EXPECT_FALSE(obs->axes[0].rotary);
  ASSERT_EQ(obs->lines.size(), 1U);
  EXPECT_EQ(obs->lines[0].sense, (std::array<double, 3>{0, 1, 0}));
  EXPECT_EQ(obs->source_line, (std::vector<std::uint32_t>{4, 5}));
}

TEST(Csv, RotaryAxisIsInRadians) {
  const auto obs =
      read_text("run,direction,target_deg,deviation_arcsec\n1,+,90,3.6\n", "axis", "C");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_TRUE(obs->angular);
  EXPECT_TRUE(obs->axes[0].rotary);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[0], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(obs->deviation[0], 0.001 * std::numbers::pi / 180);
  EXPECT_EQ(obs->lines[0].sense, (std::array<double, 3>{0, 0, 0}));
  const auto position =
      read_text("run,direction,target_deg,position_deg\n1,+,90,90.001\n", "axis", "C");
  ASSERT_TRUE(position);
  EXPECT_NEAR(position->deviation[0], obs->deviation[0], 1e-15);
}

TEST(Csv, StraightnessIsSensedAlongLateral) {
  const auto obs = read_text(head + "1,+,1,2\n", "straightness", "X", "Z");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_FALSE(obs->angular);
  EXPECT_EQ(obs->axes[0].axis, "X");
  EXPECT_EQ(obs->lines[0].sense, (std::array<double, 3>{0, 0, 1}));
}

TEST(Csv, AnAngleOfALinearAxisIsAnAngleOverALength) {
  const auto obs =
      read_text("run,direction,target_mm,deviation_arcsec\n1,+,500,2\n", "angle", "X", "Z");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_TRUE(obs->angular);
  EXPECT_FALSE(obs->axes[0].rotary);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[0], 0.5);
  EXPECT_NEAR(obs->deviation[0], 2.0 / arcsec_per_rad, 1e-15);
  EXPECT_EQ(obs->lines[0].sense, (std::array<double, 3>{}));
}

TEST(Csv, NoteNamesCountAndFirstLine) {
  const auto obs = read_text(head + "1,+,1,2\n1,+,2,2\n1,+,2,2\n1,+,1,2\n");
  ASSERT_TRUE(obs);
  ASSERT_EQ(obs->notes.size(), 1U);
  EXPECT_EQ(obs->notes[0].id, "csv.repeated-rows");
  EXPECT_EQ(obs->notes[0].evidence.at(0).value, 2.0);
  EXPECT_EQ(obs->notes[0].evidence.at(1).value, 4.0);
  EXPECT_EQ(obs->source_line, (std::vector<std::uint32_t>{2, 3}));
}

TEST(Csv, RepetitionIsComparedInEveryColumn) {
  const auto obs = read_text(
      "run,direction,target_mm,deviation_um,time_s,air_c\n1,+,1,2,5,\n1,+,1,2,5,\n1,-,1,2,6,20\n");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), 2U);
  EXPECT_EQ(obs->time, (std::vector<double>{5, 6}));
  EXPECT_EQ(obs->air[1], 20.0);
}

TEST(Csv, SaysNowAndThenWhatItNeedsNoMore) {
  std::string text = head;
  unsigned rows = 0;
  while (text.size() < (std::size_t{13} << 20U))
    text += std::to_string(++rows) + ",+,100.25,-1.5\n";
  std::vector<std::size_t> done;
  const auto obs =
      read_text(text, "axis", "X", "", [&](std::size_t offset) { done.push_back(offset); });
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), rows);
  ASSERT_GE(done.size(), 3U);
  for (std::size_t i = 0; i < done.size(); ++i) {
    EXPECT_LE(done[i], text.size());
    EXPECT_LE(done[i] - (i == 0 ? 0 : done[i - 1]), (std::size_t{4} << 20U) + 100);
    EXPECT_EQ(text[done[i] - 1], '\n');
  }
}

TEST(Csv, MoreRowsThanTheWindowsPromised) {
  // Long comments where the windows look: the estimate is far too small, the reading is not.
  std::string text = head;
  for (unsigned i = 1; i <= 2000; ++i) {
    text += "#" + std::string(4000, 'c') + "\n";
    text += std::to_string(i) + ",-,1,2\n";
  }
  const auto obs = read_text(text);
  ASSERT_TRUE(obs);
  EXPECT_EQ(obs->size(), 2000U);
}

TEST(Csv, ManyPassesAreStillHeldAgainstEachOther) {
  std::string text = head;
  for (unsigned i = 1; i <= 120000; ++i) text += std::to_string(i) + ",+,1,2\n";
  const auto good = read_text(text);
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_EQ(good->size(), 120000U);
  const auto bad = read_text(text + "7,+,1,3\n");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().line, 120002U);
  EXPECT_NE(bad.error().message.find("line 8"), std::string::npos) << bad.error().message;
}

TEST(Csv, RecognisesItsHeader) {
  for (const std::string& yes :
       {head, "\xEF\xBB\xBF# a\n\nrun;direction;target_mm"s, "targt_mm,run\n"s, "run\tx\n"s})
    EXPECT_TRUE(recognises(yes)) << yes;
  for (const std::string& no :
       {""s, "1,2,3\n"s, "# only\n"s, "HEADER::\r\nFile Type: 1\r\n"s, "\0\0\0run,\0"s, "{}"s})
    EXPECT_FALSE(recognises(no)) << no;
  // To be refused with a word for it, whatever the order of the bytes.
  for (const std::string& wide :
       {"\xFF\xFEr\0u\0n\0,\0x\0\n\0"s, "\xFE\xFF\0r\0u\0n\0;\0x"s, "r\0u\0n\0,\0"s})
    EXPECT_TRUE(recognises(wide));
}

TEST(Csv, ReadsItsKinds) {
  for (const char* kind :
       {"axis", "straightness", "angle", "diagonal", "step-diagonal", "ball-centres", "rtcp",
        "observations", "circle", "thermal", "spindle", "lengths"})
    EXPECT_TRUE(reads(kind)) << kind;
  for (const char* kind : {"", "Axis", "circular"}) EXPECT_FALSE(reads(kind)) << kind;
}

}  // namespace
}  // namespace nonio::csv::csv_reader_test
