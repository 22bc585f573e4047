// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/format.h"
#include "workshop.h"

namespace linuxcnc_test {

using namespace workshop;

namespace {

Measured invented() {
  Measured m;
  m.targets = {0.0, 50 * mm, 100 * mm};
  m.plus = [](double x) { return (x < 0.04 ? 10 : x < 0.06 ? 30 : 50) * um; };
  m.minus = [](double x) { return (x < 0.04 ? -20 : x < 0.06 ? -10 : 0) * um; };
  return m;
}

Options type(std::int64_t t) { return {{"type", t}}; }

}  // namespace

// Zero at 0: the mean there, -5 um, is the instrument's. Tables of this form were run on the real
// controller (tests/external/linuxcnc).
TEST(LinuxCnc, TypeZeroByHand) {
  const auto r = Bench(invented()).write(linuxcnc_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(file(*r, "linuxcnc-X.comp"),
            "0.00000000 0.01500000 -0.01500000\n"
            "50.00000000 50.03500000 49.99500000\n"
            "100.00000000 100.05500000 100.00500000\n");
  const auto c = control(linuxcnc_plugin(), {{"linuxcnc-X.comp", file(*r, "linuxcnc-X.comp")}});
  ASSERT_TRUE(c);
  const double seen[][3] = {{0, 1, -0.015},    {50, 1, -0.035}, {100, 1, -0.055}, {150, 1, -0.055},
                            {100, -1, -0.005}, {50, -1, 0.005}, {0, -1, 0.015},   {-50, -1, 0.015}};
  for (const auto& s : seen)
    EXPECT_NEAR((*c)(s[0] * mm, static_cast<int>(s[1])), s[2] * mm, 1e-11) << s[0] << " " << s[1];
}

TEST(LinuxCnc, TypeOneHasTheOppositeSign) {
  const auto r = Bench(invented()).write(linuxcnc_plugin(), type(1));
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(lines(file(*r, "linuxcnc-X.comp"))[1], "50.00000000 -0.03500000 0.00500000");
  EXPECT_TRUE(contains(file(*r, "linuxcnc-X.ini"), "COMP_FILE_TYPE = 1\n"));
  EXPECT_LT(prediction(*r, "E").after, 0.05 * um);
}

// The reader stops at the first line that is not three numbers: no other lines are allowed.
TEST(LinuxCnc, EveryLineIsThreeNumbers) {
  const auto r = Bench(invented()).write(linuxcnc_plugin());
  ASSERT_TRUE(r);
  const std::string text = file(*r, "linuxcnc-X.comp");
  EXPECT_EQ(text.find_first_not_of("0123456789.- \n"), std::string::npos);
  EXPECT_EQ(read_back(linuxcnc_plugin(), {{"linuxcnc-X.comp", text}})->front().plus.size(), 3U);
  EXPECT_FALSE(read_back(linuxcnc_plugin(), {{"linuxcnc-X.comp", "# X\n" + text}}));
  const std::string ini = file(*r, "linuxcnc-X.ini");
  EXPECT_TRUE(contains(ini, "[JOINT_0]\nCOMP_FILE = linuxcnc-X.comp\nCOMP_FILE_TYPE = 0\n"));
  EXPECT_TRUE(contains(file(*r, "linuxcnc-X.txt"), "BACKLASH is ignored"));
}

TEST(LinuxCnc, NonConstantReversalNeedsNoWish) {
  Measured m = invented();
  m.runs = 5;
  m.scatter = 0.1 * um;
  m.minus = [](double x) { return (x < 0.04 ? 20 : x < 0.06 ? 30 : 40) * um; };
  const Bench b(m);
  const auto r = b.write(linuxcnc_plugin());
  ASSERT_TRUE(r);
  EXPECT_EQ(finding(*r, "table.refused-reversal"), nullptr);
  EXPECT_LE(prediction(*r, "B").after, std::max(U_of_largest_reversal(b), 0.02 * um));
}

TEST(LinuxCnc, OneDirectionFillsBothColumns) {
  Measured m = invented();
  m.minus = {};
  const auto r = Bench(m).write(linuxcnc_plugin());
  ASSERT_TRUE(r);
  EXPECT_EQ(lines(file(*r, "linuxcnc-X.comp"))[1], "50.00000000 50.02000000 50.02000000");
  EXPECT_LT(prediction(*r, "E+").after, 0.05 * um);
  EXPECT_EQ(r->predictions.size(), 1U);
}

TEST(LinuxCnc, MoreThan256LinesAreThinnedOrRefused) {
  Measured m = invented();
  m.plus = m.minus = [](double x) { return 10 * um * std::sin(20 * x); };
  m.targets = even(0.0, 2 * mm, 300);
  EXPECT_FALSE(Bench(m).write(linuxcnc_plugin()));
  const auto r = Bench(m).write(linuxcnc_plugin(), {{"step_mm", 4.0}});
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(lines(file(*r, "linuxcnc-X.comp")).size(), 151U);
  m.targets = even(0.0, 2 * mm, 256);
  EXPECT_TRUE(Bench(m).write(linuxcnc_plugin()));
}

// What the control refuses, or ignores without a message, is no shorter table.
TEST(LinuxCnc, WhatTheControlRefusesOrIgnoresIsAnError) {
  const auto table = [](int lines, double step) {
    std::string text;
    for (int i = 0; i < lines; ++i)
      text += fixed_text(step * i, 3) + " " + fixed_text(step * i, 3) + " " +
              fixed_text(step * i, 3) + "\n";
    return text;
  };
  const auto read = [&](const std::string& text) {
    return read_back(linuxcnc_plugin(), {{"linuxcnc-X.comp", text}});
  };
  EXPECT_TRUE(read(table(256, 2.0)));
  const auto many = read(table(257, 2.0));
  ASSERT_FALSE(many);
  EXPECT_TRUE(contains(many.error().message, "line 257: the control refuses more than 256"));
  for (const double step : {-2.0, 0.0}) {  // usual for Z from 0 to -200
    const auto falling = read(table(11, step));
    ASSERT_FALSE(falling);
    EXPECT_TRUE(contains(falling.error().message, "line 2: the nominal position")) << step;
  }
}

TEST(LinuxCnc, InchMachine) {
  const auto r = Bench(invented()).write(linuxcnc_plugin(), {{"units", std::string("inch")}});
  ASSERT_TRUE(r);
  EXPECT_EQ(lines(file(*r, "linuxcnc-X.comp"))[1], "1.96850394 1.96988189 1.96830709");
  EXPECT_LT(prediction(*r, "E").after, 0.05 * um);
}

TEST(LinuxCnc, TurnIsClosedByHand) {
  Measured m;
  m.axis = m.id = "A";
  m.rotary = true;
  m.targets = even(0.0, 30 * deg, 12);
  m.plus = [](double x) { return 10 * arcsec * std::cos(x); };
  m.minus = [p = m.plus](double x) { return p(x) + 3 * arcsec; };
  const auto r = Bench(m).write(linuxcnc_plugin(), type(1));
  ASSERT_TRUE(r);
  const auto all = lines(file(*r, "linuxcnc-A.comp"));
  ASSERT_EQ(all.size(), 13U);
  EXPECT_EQ(all.front().substr(10), all.back().substr(12));
  EXPECT_EQ(all.back().substr(0, 12), "360.00000000");
}

}  // namespace linuxcnc_test
