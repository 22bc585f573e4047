// SPDX-License-Identifier: Apache-2.0
// Measurements of several axes at once.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "csv.h"

namespace nonio::csv::spatial_test {
namespace {

Measurement measurement(const std::string& kind) {
  Measurement m;
  m.id = "D1";
  m.kind = kind;
  m.axis = kind == "ball-centres" || kind == "rtcp" ? "C" : "";
  m.file = "d1.csv";
  m.from = {{"X", 0.0}, {"Y", 9.0}};
  m.to = {{"X", 12.0}, {"Y", 0.0}};
  if (kind == "step-diagonal") {
    m.from = {{"X", 0.1}, {"Y", 0.0}, {"Z", 0.0}};
    m.to = {{"X", 0.9}, {"Y", 0.6}, {"Z", -0.6}};
  }
  return m;
}

Expected<Observations> read_text(const std::string& text, const Measurement& m) {
  Campaign campaign;
  for (const char* name : {"X", "Y", "B", "C"}) {
    Axis axis;
    axis.name = name;
    axis.rotary = axis.name == "C" || axis.name == "B";
    campaign.machine.axes.push_back(axis);
  }
  const Settings options;
  return read({text, campaign, m, options, {}});
}
Expected<Observations> read_text(const std::string& text, const std::string& kind) {
  return read_text(text, measurement(kind));
}

Measurement circle_of(const std::string& plane) {
  Measurement m;
  m.id = "C1", m.kind = "circle", m.file = "c1.csv";
  m.from = {{plane.substr(0, 1), 0.4}, {plane.substr(1), 0.2}};
  m.to = {{plane.substr(0, 1), 0.5}, {plane.substr(1), 0.2}};
  return m;
}

TEST(Circle, AnglesGoFromTheFirstAxisToTheSecond) {
  const std::string rows =
      "direction,angle_deg,deviation_um\n+,0,1\n+,30,2\n+,90,nan\n+,200,4\n-,300,5\n-,0,6\n";
  for (const std::string plane : {"XY", "YZ", "ZX"}) {
    const auto obs = read_text(rows, circle_of(plane));
    ASSERT_TRUE(obs) << obs.error().message;
    const auto *u = obs->axis(plane.substr(0, 1)), *v = obs->axis(plane.substr(1));
    ASSERT_NE(u, nullptr);
    ASSERT_NE(v, nullptr);
    ASSERT_EQ(obs->size(), 5U);
    EXPECT_EQ(obs->missing, 1U);
    // Clockwise first: -300, -0, +0, +30, +200.
    EXPECT_DOUBLE_EQ(u->position[2], 0.5);
    EXPECT_NEAR(u->position[3], 0.4 + 0.1 * std::cos(std::numbers::pi / 6.0), 1e-15);
    EXPECT_NEAR(v->position[3], 0.25, 1e-15);
    // At 0 deg the first axis is at its end: it came there towards +, then goes back.
    EXPECT_EQ(u->approach, (std::vector<std::int8_t>{-1, 1, 1, -1, 1}));
    EXPECT_EQ(v->approach, (std::vector<std::int8_t>{-1, -1, 1, 1, -1}));
    ASSERT_EQ(obs->lines.size(), 2U);
    EXPECT_EQ(obs->lines[0].name, "C1 -");
    EXPECT_EQ(obs->lines[1].name, "C1 +");
    EXPECT_NEAR(obs->sense[3][coordinate_of(plane.substr(1))], 0.5, 1e-15);
  }
}

TEST(Circle, RowsThatDoNotTurnAreRefused) {
  const std::string head = "direction,angle_deg,deviation_um\n";
  for (const std::string wrong : {"+,0,1\n+,20,1\n+,10,1\n", "-,0,1\n-,10,1\n", "+,,1\n", "x,0,1\n",
                                  "+,0,one\n", "+,0,nan\n", ""})
    EXPECT_FALSE(read_text(head + wrong, circle_of("XY"))) << wrong;
  const auto error = read_text(head + "+,0,1\n+,20,1\n+,10,1\n", circle_of("XY")).error();
  EXPECT_EQ(error.line, 4U);
  EXPECT_EQ(error.column, "angle_deg");
  Measurement none;
  none.id = "C1", none.kind = "circle";
  EXPECT_FALSE(read_text(head + "+,0,1\n", none));
}

TEST(Circle, ArcsBeforeAndBehindTheTurnAreNotEvaluated) {
  std::string rows = "direction,angle_deg,deviation_um\n";
  for (int i = -30; i <= 390; i += 10) rows += "+," + std::to_string(i) + ",1\n";
  Measurement m = circle_of("XY");
  EXPECT_FALSE(read_text(rows, m));  // more than a turn, without over_travel
  m.over_travel = 30.0 * std::numbers::pi / 180.0;
  const auto obs = read_text(rows, m);
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), 37U);  // 0 to 360
  ASSERT_EQ(obs->notes.size(), 1U);
  EXPECT_EQ(obs->notes[0].id, "csv.over-travel");
  m.over_travel = 10.0 * std::numbers::pi / 180.0;
  EXPECT_FALSE(read_text(rows, m));
}

TEST(Diagonal, DistancesBecomePositionsOfBothAxes) {
  const auto obs =
      read_text("run,direction,target_mm,deviation_um\n1,+,500,-1.5\n1,-,15000,2\n", "diagonal");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->axes.size(), 2U);
  EXPECT_EQ(obs->axes[0].axis, "X");
  EXPECT_DOUBLE_EQ(obs->axes[0].position[0], 0.4);
  EXPECT_DOUBLE_EQ(obs->axes[1].position[0], 9.0 - 0.3);
  EXPECT_DOUBLE_EQ(obs->axes[1].position[1], 0.0);
  EXPECT_EQ(obs->axes[0].approach, (std::vector<std::int8_t>{1, -1}));
  EXPECT_EQ(obs->axes[1].approach, (std::vector<std::int8_t>{-1, 1}));
  ASSERT_EQ(obs->lines.size(), 1U);
  EXPECT_DOUBLE_EQ(obs->lines[0].sense[0], 0.8);
  EXPECT_DOUBLE_EQ(obs->lines[0].sense[1], -0.6);
  EXPECT_DOUBLE_EQ(obs->deviation[0], -1.5e-6);
}

TEST(Diagonal, ItsEndsAreChecked) {
  const std::string text = "run,direction,target_mm,deviation_um\n1,+,500,-1.5\n1,+,15001,2\n";
  const auto beyond = read_text(text, "diagonal");
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().line, 3U);
  EXPECT_NE(beyond.error().message.find("15000.000 mm"), std::string::npos);
  Measurement m = measurement("diagonal");
  m.to["Y"] = 9.0;
  EXPECT_FALSE(read_text(text, m));
  m.to.erase("Y");
  EXPECT_FALSE(read_text(text, m));
  m = measurement("diagonal");
  m.from["C"] = 0.0;
  m.to["C"] = 1.0;
  EXPECT_FALSE(read_text(text, m));
  EXPECT_FALSE(read_text("run,direction,target_deg,deviation_um\n1,+,5,1\n", "diagonal"));
}

std::string steps(const std::string& diagonal, int n) {
  std::string text;
  for (int step = 1; step <= 3 * n; ++step)
    text += diagonal + "," + std::to_string(step) + "," + "XYZ"[(step - 1) % 3] + ",1.0\n";
  return text;
}
const std::string step_head = "diagonal,step,moved,deviation_um\n";

TEST(StepDiagonal, PositionsFollowTheMoves) {
  const auto obs = read_text(step_head + steps("PPP", 2) + steps("NPP", 2), "step-diagonal");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 12U);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[0], 0.5);  // after the first move of X
  EXPECT_DOUBLE_EQ(obs->axes[1].position[0], 0.0);
  EXPECT_DOUBLE_EQ(obs->axes[2].position[5], -0.6);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[6], 0.5);  // NPP starts at X = 0.9
  EXPECT_DOUBLE_EQ(obs->axes[0].position[11], 0.1);
  EXPECT_EQ(obs->axes[2].approach[0], -1);  // towards smaller coordinates
  EXPECT_EQ(obs->axes[0].approach[6], -1);
  const double length = std::sqrt(0.64 + 0.36 + 0.36);
  ASSERT_EQ(obs->lines.size(), 2U);
  EXPECT_EQ(obs->lines[1].name, "D1 NPP");
  EXPECT_DOUBLE_EQ(obs->lines[1].sense[0], -0.8 / length);
  EXPECT_DOUBLE_EQ(obs->lines[1].sense[2], -0.6 / length);
}

TEST(StepDiagonal, BadMovesAreErrorsWithTheirLine) {
  const auto error = [](const std::string& text) {
    const auto obs = read_text(step_head + text, "step-diagonal");
    EXPECT_FALSE(obs) << text;
    return obs ? Error{} : obs.error();
  };
  EXPECT_EQ(error("PPX,1,X,1\n").line, 2U);
  EXPECT_EQ(error("PPP,1,A,1\n").column, "moved");
  EXPECT_EQ(error("PPP,1.5,X,1\n").column, "step");
  EXPECT_EQ(error("PPP,1,X,1\nPPP,2,Y,1\n").column, "step");              // 2 of 3
  EXPECT_EQ(error("PPP,1,X,1\nPPP,3,Z,1\nPPP,3,Z,1\n").line, 3U);         // 2 is missing
  EXPECT_EQ(error("PPP,1,X,1\nPPP,2,X,1\nPPP,3,Z,1\n").column, "moved");  // X twice
  EXPECT_EQ(error("PPP,1,X,1\nPPP,2,Y,1\nPPP,3,Z,1\nPPP,3,Z,2\n").line, 5U);
}

TEST(StepDiagonal, StepsNotTakenAreMissing) {
  const auto obs =
      read_text(step_head + "PPP,1,X,1\nPPP,2,Y,nan\nPPP,3,Z,1\nPPP,3,Z,1\n", "step-diagonal");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), 2U);
  EXPECT_EQ(obs->missing, 1U);
  EXPECT_EQ(obs->notes.size(), 1U);  // the repeated row
}

TEST(BallCentres, EachCentreIsThreeReadings) {
  const auto obs =
      read_text("angle_deg;x_mm;y_mm;z_mm\n0;261,5;1;2\n90;0;262;2\n180;;1;2\n", "ball-centres");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 6U);
  EXPECT_EQ(obs->missing, 1U);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[3], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(obs->axes[1].position[2], 0.2615);
  EXPECT_DOUBLE_EQ(obs->deviation[4], 0.262);
  EXPECT_EQ(obs->lines[1].sense[1], 1.0);
  EXPECT_TRUE(obs->axes[0].approach.empty());
  Measurement m = measurement("ball-centres");
  m.axis = "X";
  EXPECT_FALSE(read_text("angle_deg,x_mm,y_mm,z_mm\n0,1,2,3\n", m));
  EXPECT_FALSE(read_text("angle_deg,x_mm,y_mm,z_mm\n,1,2,3\n", "ball-centres"));
  EXPECT_FALSE(read_text("angle_deg;x_mm;y_mm;z_mm\n0;1,5;2.5;3\n", "ball-centres"));
}

/// In addition to the axis of the measurement; the other axes keep their columns.
TEST(BallCentres, MayHaveTheAngleOfAnotherAxis) {
  const auto obs =
      read_text("angle_deg,B_deg,x_mm,y_mm,z_mm\n0,-60,1,2,3\n90,30,4,5,6\n", "ball-centres");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->axes.size(), 5U);
  EXPECT_TRUE(obs->axes[3].axis == "Z" && obs->axes[4].axis == "B" && obs->axes[4].rotary);
  EXPECT_DOUBLE_EQ(obs->axes[4].position[2], -std::numbers::pi / 3);
  EXPECT_FALSE(read_text("angle_deg,B_deg,x_mm,y_mm,z_mm\n0,,1,2,3\n", "ball-centres"));
  EXPECT_FALSE(read_text("angle_deg,A_deg,x_mm,y_mm,z_mm\n0,1,1,2,3\n", "ball-centres"));
}

/// Places that go round left-handed: a gauge that turns points with them.
TEST(ToolCentre, AGaugeThatTurnsIsTurnedWithTheAxis) {
  const auto obs = read_text(
      "angle_deg,x_mm,y_mm,z_mm,tx,ty,tz,deviation_um,line\n"
      "0,110,20,5,1,0,0,1.5,a\n90,10,-80,5,1,0,0,-2,a\n180,-90,20,5,1,0,0,nan,a\n"
      "270,10,120,5,1,0,0,3,a\n",
      "rtcp");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 3U);
  EXPECT_EQ(obs->missing, 1U);
  EXPECT_DOUBLE_EQ(obs->deviation[1], -2e-6);
  EXPECT_DOUBLE_EQ(obs->axes[2].position[1], -0.08);
  const double senses[][2] = {{1, 0}, {0, -1}, {0, 1}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(obs->sense_of(i)[k], senses[i][k], 1e-12) << i << " " << k;
}

TEST(ToolCentre, AProbeIsThreeReadingsOfTheTool) {
  const auto obs = read_text(
      "run,direction,angle_deg,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n1,+,0,1,2,3,4,5,-6\n", "rtcp");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 3U);
  EXPECT_EQ(obs->lines[2].name, "D1 found z");
  EXPECT_EQ(obs->lines[2].sense[2], 1.0);
  EXPECT_DOUBLE_EQ(obs->deviation[2], 6e-6);  // found below: the tool is above
  EXPECT_EQ(obs->axes[0].approach[0], 1);
}

TEST(ToolCentre, RefusesWhatItCannotRead) {
  const std::string places = "angle_deg,x_mm,y_mm,z_mm,";
  for (const auto& [text, says] :
       {std::pair<std::string, const char*>{places + "deviation_um\n0,1,2,3,4\n", "nx, ny, nz"},
        {places + "nx,ny,nz,dx_um,dy_um,dz_um\n0,1,2,3,1,0,0,1,1,1\n", "dx_um"},
        {places + "nx,ny,nz,deviation_um\n0,1,2,3,1,1,0,4\n", "length"},
        {places + "tx,ty,tz,deviation_um\n0,1,2,3,1,0,0,4\n90,1,2,3,1,0,0,4\n", "go round"}}) {
    const auto obs = read_text(text, "rtcp");
    ASSERT_FALSE(obs) << text;
    EXPECT_NE(obs.error().message.find(says), std::string::npos) << obs.error().message;
    EXPECT_EQ(obs.error().file, "d1.csv");
  }
}

TEST(General, LinesAndSenses) {
  const auto obs = read_text(
      "X_mm,Y_mm,X_dir,nx,ny,nz,deviation_um,line,time_s\n"
      "0,0,+,1,0,0,1,a,0\n10,0,-,1,0,0,2,a,1\n10,5,,0,1,0,3,b,2\n",
      "observations");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->lines.size(), 2U);
  EXPECT_TRUE(obs->sense.empty());
  EXPECT_EQ(obs->line, (std::vector<std::uint32_t>{0, 0, 1}));
  EXPECT_EQ(obs->axes[0].approach, (std::vector<std::int8_t>{1, -1, 0}));
  EXPECT_TRUE(obs->axes[1].approach.empty());
  EXPECT_EQ(obs->sense_of(2)[1], 1.0);
  EXPECT_EQ(obs->time[2], 2.0);
  const auto mixed =
      read_text("X_mm,nx,ny,nz,deviation_um\n0,1,0,0,1\n1,0,1,0,2\n", "observations");
  ASSERT_TRUE(mixed);
  EXPECT_EQ(mixed->sense.size(), 2U);
  EXPECT_EQ(mixed->sense_of(1)[1], 1.0);
}

TEST(General, BadTables) {
  EXPECT_FALSE(read_text("nx,ny,nz,deviation_um\n1,0,0,1\n", "observations"));
  EXPECT_FALSE(read_text("X_mm,nx,ny,nz,deviation_um\n0,1,1,0,1\n", "observations"));
  EXPECT_FALSE(read_text("X_deg,nx,ny,nz,deviation_um\n0,1,0,0,1\n", "observations"));
  EXPECT_FALSE(read_text("Y_mm,X_dir,nx,ny,nz,deviation_um\n0,+,1,0,0,1\n", "observations"));
  EXPECT_FALSE(read_text("X_mm,nx,ny,nz,deviation_um\n0,1,0,0,nan\n", "observations"));
  EXPECT_FALSE(read_text("", "observations"));
}

TEST(Thermal, ASensorIsALineAndTheSpindleTurns) {
  const auto obs = read_text(
      "time_s,speed_rpm,x1_um,z_um,air_c\n0,0,1,0,20\n60,600,2,5,20.1\n120,600,nan,7,\n180,0,3,9,"
      "21\n",
      "thermal");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), 7U);
  EXPECT_EQ(obs->missing, 1U);
  ASSERT_EQ(obs->lines.size(), 2U);
  EXPECT_EQ(obs->lines[0].name, "X1");
  EXPECT_EQ(obs->lines[1].sense, (std::array<double, 3>{0.0, 0.0, 1.0}));
  ASSERT_EQ(obs->axes.size(), 1U);
  EXPECT_EQ(obs->axes[0].approach, (std::vector<std::int8_t>{0, 1, 0, 0, 1, 1, 0}));
  // A speed holds until the next row: 600 rpm for two minutes are 1,200 turns.
  EXPECT_NEAR(obs->axes[0].position.back(), 1200.0 * 2.0 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(obs->deviation[1], 2e-6, 1e-20);
  const auto at_rest = read_text("time_s,y_um\n0,0\n60,1\n", "thermal");
  ASSERT_TRUE(at_rest) << at_rest.error().message;
  EXPECT_EQ(at_rest->axes[0].approach, (std::vector<std::int8_t>{0, 0}));
}

TEST(Thermal, AnAxisThatIsExercisedCountsItsCycles) {
  Measurement m = measurement("thermal");
  m.axis = "X";
  const std::string text =
      "time_s,direction,target_mm,deviation_um\n0,+,20,1\n9,+,780,2\n20,-,780,1\n30,-,20,0\n"
      "40,+,20,3\n50,+,780,9\n";
  const auto obs = read_text(text, m);
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->run, (std::vector<std::uint32_t>{1, 1, 1, 1, 2, 2}));
  EXPECT_NEAR(obs->axes[0].position[1], 0.78, 1e-12);
  m.axis = "C";
  EXPECT_FALSE(read_text(text, m)) << "a rotary axis has sensors";
  m.axis = "";
  EXPECT_FALSE(read_text(text, m)) << "columns of an axis, and none is stated";
}

TEST(Thermal, AnExactlyRepeatedRowIsDroppedWithANote) {
  const auto obs = read_text(
      "time_s,x_um,air_c\n0,1,20\n60,2,\n60,2,\n60,2,\n120,nan,21\n120,nan,21\n180,4,22\n",
      "thermal");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->time, (std::vector<double>{0.0, 60.0, 180.0}));
  EXPECT_EQ(obs->source_line, (std::vector<std::uint32_t>{2, 3, 8}));
  EXPECT_EQ(obs->missing, 1U);
  ASSERT_EQ(obs->notes.size(), 1U);
  EXPECT_EQ(obs->notes[0].id, "csv.repeated-rows");
  EXPECT_EQ(obs->notes[0].evidence[0].value, 3.0);
  EXPECT_EQ(obs->notes[0].evidence[1].value, 4.0);
}

TEST(Thermal, ABlankSpeedIsAMissingReadingOfThatChannel) {
  const auto obs = read_text("time_s,speed_rpm,x_um\n0,,0\n60,600,1\n120,,2\n180,0,3\n", "thermal");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->channels.size(), 1U);
  EXPECT_EQ(obs->channels[0].time, (std::vector<double>{60.0, 180.0}));
  // The spindle keeps the speed that it had.
  EXPECT_EQ(obs->axes[0].approach, (std::vector<std::int8_t>{0, 1, 1, 0}));
  EXPECT_NEAR(obs->axes[0].position.back(), 1200.0 * 2.0 * std::numbers::pi, 1e-6);
}

TEST(Thermal, AnAirThermometerWithoutContactIsMissing) {
  const auto obs = read_text("time_s,x_um,air_c\n0,1,20\n60,2,-127\n120,3,21\n", "thermal");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->air.size(), 3U);
  EXPECT_TRUE(std::isnan(obs->air[1]));
}

TEST(Thermal, BadTables) {
  for (const char* same_or_earlier : {"60,3", "59,2"}) {
    const auto back =
        read_text("time_s,x_um\n0,1\n60,2\n" + std::string(same_or_earlier) + "\n", "thermal");
    ASSERT_FALSE(back);
    EXPECT_EQ(back.error().line, 4U);
    EXPECT_EQ(back.error().column, "time_s");
    EXPECT_NE(back.error().message.find("later than that of line 3"), std::string::npos);
  }
  for (const char* bad :
       {"", "time_s\n0\n", "x_um\n1\n", "time_s,x_um\n0,nan\n60,-1e20\n", "time_s,x_um\nnan,1\n",
        "time_s,x_mm\n0,1\n", "time_s,speed_rpm,x_um\n0,9e9,1\n60,1,1\n"})
    EXPECT_FALSE(read_text(bad, "thermal")) << bad;
}

TEST(Lengths, TestAndPositionAreALine) {
  const auto obs = read_text(
      "test,position,length_mm,repeat,deviation_um\nE0,1,100,1,0.5\nE0,1,100,2,n/"
      "a\nEL,1,100,1,-2\n",
      "lengths");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->lines.size(), 2U);
  EXPECT_EQ(obs->lines[1].name, "EL 1");
  EXPECT_EQ(obs->missing, 1U);
  EXPECT_NEAR(obs->deviation[1], -2e-6, 1e-20);
  const auto twice = read_text(
      "test,position,length_mm,repeat,deviation_um\nE0,1,100,1,0.5\nE0,1,100,1,0.6\n", "lengths");
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().line, 3U);
  for (const char* bad : {"test,position,length_mm,repeat,deviation_um\nE1,1,100,1,0\n",
                          "test,position,length_mm,repeat,deviation_um\nE0,0,100,1,0\n",
                          "test,position,length_mm,repeat,deviation_um\nE0,1,-5,1,0\n",
                          "test,position,length_mm,repeat\nE0,1,100,1\n", ""})
    EXPECT_FALSE(read_text(bad, "lengths")) << bad;
}

TEST(Lengths, APointIsThreeReadings) {
  const auto obs = read_text("x_mm,y_mm,z_mm\n1,2,3\n4,,6\n7,8,9\n", "lengths");
  ASSERT_TRUE(obs) << obs.error().message;
  EXPECT_EQ(obs->size(), 6U);
  EXPECT_EQ(obs->missing, 1U);
  EXPECT_NEAR(obs->deviation[5], 9e-3, 1e-15);
  EXPECT_EQ(obs->sense[4], (std::array<double, 3>{0.0, 1.0, 0.0}));
}

}  // namespace
}  // namespace nonio::csv::spatial_test
