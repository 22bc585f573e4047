// SPDX-License-Identifier: Apache-2.0
#include "workshop.h"

namespace heidenhain_test {

using namespace workshop;

namespace {

Measured two_axes_x() {
  Measured m;
  m.targets = {-100 * mm, 0.0, 100 * mm};
  m.plus = [](double x) { return x * 20 * um / 0.1; };
  m.minus = [](double x) { return x * 20 * um / 0.1 + 5 * um; };
  return m;
}

/// The .COM file that the active line of a .CMA names for an axis: a cell starts where its heading
/// does.
std::string assigned(const std::string& cma, const std::string& axis) {
  const auto all = lines(cma);
  const auto cell = [&](const std::string& line, const std::string& heading) {
    const std::size_t at = all[1].find(" " + heading) + 1;
    return at < line.size() ? line.substr(at, line.find(' ', at) - at) : std::string();
  };
  for (std::size_t i = 2; i < all.size(); ++i)
    if (cell(all[i], "ACTIVE") == "*") return cell(all[i], axis);
  return "";
}

Options layout(const char* name) { return {{"layout", std::string(name)}}; }

}  // namespace

TEST(Heidenhain, ListedLayoutByHand) {
  const auto r = Bench(two_axes_x()).write(heidenhain_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(file(*r, "heidenhain-tnc-X.COM"),
            "BEGIN AXIS_X.COM MM\n"
            "NR   AXISPOS       BACKLASH      X\n"
            "0    -100.0000                   -0.0200\n"
            "1    +0.0000                     +0.0000\n"
            "2    +100.0000                   +0.0200\n"
            "[END]\n");
  EXPECT_TRUE(contains(file(*r, "heidenhain-tnc-X.txt"), "backLash = +0.0050\n"));
  EXPECT_EQ(file(*r, "heidenhain-tnc-CONFIG.CMA"),
            "BEGIN CONFIG.CMA MM\nNR   ACTIVE   X\n0    *        AXIS_X.COM\n[END]\n");
  EXPECT_LT(prediction(*r, "E").after, 0.06 * um);
}

// The same place for the 4 decimals of the table, two targets for the test.
TEST(Heidenhain, TargetsThatPrintAlikeAreOneRow) {
  Measured m = two_axes_x();
  m.targets = {-100 * mm, 0.0, 0.00002 * mm, 100 * mm};
  const auto r = Bench(m).write(heidenhain_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(lines(file(*r, "heidenhain-tnc-X.COM")).size(), 6U);
  EXPECT_LT(prediction(*r, "E").after, 0.06 * um);
}

TEST(Heidenhain, EquidistantLayoutByHand) {
  const auto r = Bench(two_axes_x()).write(heidenhain_plugin(), layout("itnc530"));
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(file(*r, "heidenhain-tnc-X.COM"),
            "BEGIN AXIS-X.COM  DATUM:-100.0000 DISTANCE:+100.0000\n"
            "NR                  X\n"
            "0       -100.0000   -0.0200\n"
            "1       +0.0000     +0.0000\n"
            "2       +100.0000   +0.0200\n");
  EXPECT_LT(prediction(*r, "E").after, 0.06 * um);
}

TEST(Heidenhain, SecondAxisHasItsOwnColumn) {
  Bench b(two_axes_x());
  Measured y = two_axes_x();
  y.axis = y.id = "Y";
  b.add(y);
  const auto r = b.write(heidenhain_plugin());
  ASSERT_TRUE(r);
  EXPECT_EQ(lines(file(*r, "heidenhain-tnc-Y.COM"))[1],
            "NR   AXISPOS       BACKLASH      X             Y");
  EXPECT_EQ(lines(file(*r, "heidenhain-tnc-Y.COM"))[2],
            "0    -100.0000                                 -0.0200");
  const std::string cma = file(*r, "heidenhain-tnc-CONFIG.CMA");
  EXPECT_EQ(assigned(cma, "X"), "AXIS_X.COM");
  EXPECT_EQ(assigned(cma, "Y"), "AXIS_Y.COM");
  const Artifact com{"", file(*r, "heidenhain-tnc-Y.COM")};
  EXPECT_TRUE(control(heidenhain_plugin(), {com}, {}, "Y"));
  EXPECT_FALSE(control_cross(heidenhain_plugin(), {com}, "Y", "X")) << "the column of X is empty";
}

TEST(Heidenhain, DirectionsFillTheBacklashColumn) {
  auto options = layout("tnc640");
  options["directions"] = true;
  const auto r = Bench(two_axes_x()).write(heidenhain_plugin(), options);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(lines(file(*r, "heidenhain-tnc-X.COM"))[2], "0    -100.0000     -0.0175       -0.0225");
  EXPECT_TRUE(contains(file(*r, "heidenhain-tnc-X.txt"), "backLash = +0.0000\n"));
  EXPECT_LT(prediction(*r, "B").after, 0.05 * um);
  options["layout"] = std::string("itnc530");
  const auto refused = Bench(two_axes_x()).write(heidenhain_plugin(), options);
  ASSERT_FALSE(refused);
  EXPECT_TRUE(contains(refused.error().message, "tnc640"));
}

TEST(Heidenhain, PowerOfTwoSpacingStillCompensates) {
  Measured m = two_axes_x();
  m.targets = even(0.0, 25 * mm, 21);
  m.plus = [](double x) { return 20 * um * std::sin(12 * x); };
  m.minus = [p = m.plus](double x) { return p(x) + 5 * um; };
  const auto r = Bench(m).write(heidenhain_plugin(), layout("tnc407"));
  ASSERT_TRUE(r) << r.error().message;
  const std::string head = lines(file(*r, "heidenhain-tnc-X.COM"))[0];
  const std::size_t at = head.find("DISTANCE:+") + 10;
  const double units = std::stod(head.substr(at)) * 1e4;
  EXPECT_NEAR(std::log2(units), std::round(std::log2(units)), 1e-9) << head;
  EXPECT_LT(prediction(*r, "E").after, 0.1 * prediction(*r, "E").before);
}

TEST(Heidenhain, SpacingOfARotaryAxisIsAPowerOfTwoWithinOneTurn) {
  Measured m;
  m.axis = m.id = "C";
  m.rotary = true;
  m.plus = [](double x) { return 20 * arcsec * std::sin(x); };
  m.minus = m.plus;
  for (const int points : {13, 12}) {  // with and without the end that is the beginning
    m.targets = even(0.0, 30 * deg, points);
    const auto r = Bench(m).write(heidenhain_plugin(), layout("tnc407"));
    ASSERT_TRUE(r) << r.error().message;
    const std::string head = lines(file(*r, "heidenhain-tnc-C.COM"))[0];
    const double units = std::stod(head.substr(head.find("DISTANCE:+") + 10)) * 1e4;
    EXPECT_NEAR(std::log2(units), std::round(std::log2(units)), 1e-9) << head;
    EXPECT_LT(prediction(*r, "E").after, 0.2 * prediction(*r, "E").before);
  }
  m.targets = even(-120 * deg, 15 * deg, 11);
  const auto r = Bench(m).write(heidenhain_plugin(), layout("tnc407"));
  ASSERT_FALSE(r);
  EXPECT_TRUE(contains(r.error().message, "from 0 to 360 deg")) << r.error().message;
}

TEST(Heidenhain, TwoMeasurementsOfAnAxisMakeTwoLinesAndNoneActive) {
  Bench b(two_axes_x());
  b.campaign.measurements[0].id = "before";
  Measured after = two_axes_x();
  after.id = "after";
  b.add(after);
  const auto r = b.write(heidenhain_plugin());
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_TRUE(has_file(*r, "heidenhain-tnc-X-before.COM"));
  EXPECT_TRUE(has_file(*r, "heidenhain-tnc-X-after.COM"));
  EXPECT_NE(finding(*r, "table.two-measurements"), nullptr);
  EXPECT_EQ(assigned(file(*r, "heidenhain-tnc-CONFIG.CMA"), "X"), "");
}

TEST(Heidenhain, NamesThatFitNoColumnAreRefused) {
  Measured m = two_axes_x();
  m.axis = "Querbalken links";
  EXPECT_FALSE(Bench(m).write(heidenhain_plugin()));
}

}  // namespace heidenhain_test
