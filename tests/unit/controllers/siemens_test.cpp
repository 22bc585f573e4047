// SPDX-License-Identifier: Apache-2.0
#include "workshop.h"

namespace siemens_test {

using namespace workshop;

namespace {

// By hand: plus 0, 2, 6 um; minus 2 um more; mean 1, 3, 7; zero at 0 mm: 0, 2, 6; B = -2 um.
Measured three_points() {
  Measured m;
  m.targets = {0.0, 50 * mm, 100 * mm};
  m.plus = [](double x) { return x < 0.04 ? 0.0 : x < 0.06 ? 2 * um : 6 * um; };
  m.minus = [p = m.plus](double x) { return p(x) + 2 * um; };
  return m;
}

std::string without_comments(const std::string& text) {
  std::string out;
  for (const std::string& line : lines(text))
    if (line.empty() || line[0] != ';') out += line + "\n";
  return out;
}

}  // namespace

TEST(Siemens, EncoderTableByHand) {
  const auto r = Bench(three_points()).write(siemens_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(without_comments(file(*r, "siemens-840d-X-EEC.ini")),
            "%_N_AX1_EEC_INI\nCHANDATA(1)\n"
            "$AA_ENC_COMP[0,0,AX1]=0.0\n$AA_ENC_COMP[0,1,AX1]=0.002\n$AA_ENC_COMP[0,2,AX1]=0.006\n"
            "$AA_ENC_COMP_STEP[0,AX1]=50.0\n$AA_ENC_COMP_MIN[0,AX1]=0.0\n"
            "$AA_ENC_COMP_MAX[0,AX1]=100.0\n$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n");
  EXPECT_EQ(without_comments(file(*r, "siemens-840d-X-backlash.ini")),
            "%_N_AX1_TEA_INI\nCHANDATA(1)\n$MA_BACKLASH[0,AX1]=0.002\nM17\n");
  EXPECT_NEAR(prediction(*r, "E").before, 8 * um, 1e-15);
  EXPECT_NEAR(prediction(*r, "B").before, 2 * um, 1e-15);
  EXPECT_LT(prediction(*r, "E").after, 1e-9);
  EXPECT_LT(prediction(*r, "B").after, 1e-9);
  EXPECT_LT(prediction(*r, "M").after, 1e-9);
}

TEST(Siemens, CommentsSayMachineAxisDateAndSign) {
  const auto r = Bench(three_points()).write(siemens_plugin());
  ASSERT_TRUE(r);
  const std::string text = file(*r, "siemens-840d-X-EEC.ini");
  for (const char* part : {"; machine: Acme M 1, serial 007", "; axis X, measurement X, 2026-11-21",
                           "actual - nominal", "mean reversal B = -2.0 um"})
    EXPECT_TRUE(contains(text, part)) << part;
}

// A machine's name is not a way into the control.
TEST(Siemens, NamesCannotAddLines) {
  Bench b(three_points());
  b.campaign.machine.model = "M\n$MA_BACKLASH[0,AX1]=9\nCitt\xC3\xA0";
  const auto r = b.write(siemens_plugin());
  ASSERT_TRUE(r);
  EXPECT_TRUE(contains(file(*r, "siemens-840d-X-EEC.ini"), "M?$MA_BACKLASH[0,AX1]=9?Citt?,"));
  EXPECT_LT(prediction(*r, "E").after, 1e-9);
}

TEST(Siemens, ReferencePositionIsZero) {
  auto b = Bench(three_points());
  auto r =
      b.write(siemens_plugin(), {{"axes", std::vector<std::string>{"X reference_mm=50 number=4"}},
                                 {"measuring_system", std::int64_t{1}}});
  ASSERT_TRUE(r) << r.error().message;
  const std::string text = file(*r, "siemens-840d-X-EEC.ini");
  EXPECT_TRUE(contains(text, "$AA_ENC_COMP[1,0,AX4]=-0.002\n"));
  EXPECT_TRUE(contains(text, "$AA_ENC_COMP[1,1,AX4]=0.0\n"));
  EXPECT_LT(prediction(*r, "E").after, 1e-9);
}

TEST(Siemens, DirectionTablesByHand) {
  Measured m = three_points();
  m.minus = [](double x) { return x < 0.04 ? 4 * um : x < 0.06 ? 0.0 : 6 * um; };
  const auto r = Bench(m).write(siemens_plugin(), {{"directions", true}});
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_FALSE(has_file(*r, "siemens-840d-X-EEC.ini"));
  EXPECT_FALSE(has_file(*r, "siemens-840d-X-backlash.ini"));
  // mean at 0 mm is 2 um: plus 0, 2, 6 and minus 4, 0, 6 less that
  EXPECT_EQ(without_comments(file(*r, "siemens-840d-X-CEC.ini")),
            "%_N_NC_CEC_INI\nCHANDATA(1)\n"
            "$AN_CEC[0,0]=-0.002\n$AN_CEC[0,1]=0.0\n$AN_CEC[0,2]=0.004\n"
            "$AN_CEC_INPUT_AXIS[0]=(AX1)\n$AN_CEC_OUTPUT_AXIS[0]=(AX1)\n"
            "$AN_CEC_STEP[0]=50.0\n$AN_CEC_MIN[0]=0.0\n$AN_CEC_MAX[0]=100.0\n"
            "$AN_CEC_IS_MODULO[0]=0\n$AN_CEC_DIRECTION[0]=1\n$AN_CEC_MULT_BY_TABLE[0]=0\n"
            "$AN_CEC[1,0]=0.002\n$AN_CEC[1,1]=-0.002\n$AN_CEC[1,2]=0.004\n"
            "$AN_CEC_INPUT_AXIS[1]=(AX1)\n$AN_CEC_OUTPUT_AXIS[1]=(AX1)\n"
            "$AN_CEC_STEP[1]=50.0\n$AN_CEC_MIN[1]=0.0\n$AN_CEC_MAX[1]=100.0\n"
            "$AN_CEC_IS_MODULO[1]=0\n$AN_CEC_DIRECTION[1]=-1\n$AN_CEC_MULT_BY_TABLE[1]=0\nM17\n");
  EXPECT_LT(prediction(*r, "E").after, 2e-9);
  EXPECT_LT(prediction(*r, "B").after, 2e-9);
}

TEST(Siemens, TurnIsModuloWithEqualEnds) {
  Measured m;
  m.axis = m.id = "C";
  m.rotary = true;
  m.targets = even(0.0, 30 * deg, 13);
  m.plus = [](double x) { return 5 * arcsec * std::sin(x) + 0.2 * arcsec * x; };  // does not close
  m.minus = [p = m.plus](double x) { return p(x) + 3 * arcsec; };
  const auto r = Bench(m).write(siemens_plugin());
  ASSERT_TRUE(r) << r.error().message;
  const std::string text = file(*r, "siemens-840d-C-EEC.ini");
  for (const char* part : {"_IS_MODULO[0,AX1]=1", "_MIN[0,AX1]=0.0\n", "_MAX[0,AX1]=360.0\n",
                           "_STEP[0,AX1]=30.0\n", "[0,0,AX1]=0.0\n", "[0,12,AX1]=0.0\n"})
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
  EXPECT_EQ(prediction(*r, "E").quantity, Quantity::angular_deviation);
  EXPECT_LT(prediction(*r, "E").after, 1.5 * arcsec);
}

TEST(Siemens, TooManyPointsAreAnErrorWithASuggestion) {
  Measured m = three_points();
  m.targets = even(0.0, 250 * mm, 59);
  const auto r = Bench(m).write(siemens_plugin(), {{"step_mm", 10.0}});
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().message,
            "axis X: a step of 10 mm from 0 to 14500 mm needs 1451 points, the control takes 200: "
            "set step_mm = 73 or more");
}

TEST(Siemens, ReaderRefusesWhatTheControlWould) {
  const auto r = Bench(three_points()).write(siemens_plugin());
  ASSERT_TRUE(r);
  const std::string good = file(*r, "siemens-840d-X-EEC.ini");
  EXPECT_TRUE(control(siemens_plugin(), {{"", good}}));
  EXPECT_FALSE(control(siemens_plugin(), {{"", good}}, {{"max_points", std::int64_t{2}}}));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"$AA_ENC_COMP[0,1,AX1]=0.002\n", ""},  // a hole
           {"M17\n", ""},
           {"STEP[0,AX1]=50.0", "STEP[0,AX1]=40.0"},
           {"0.006", "0,006"},
           {"CHANDATA(1)\n", ""}}) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    EXPECT_FALSE(control(siemens_plugin(), {{"", bad}})) << from;
  }
}

}  // namespace siemens_test
