// SPDX-License-Identifier: Apache-2.0
// Tables of one axis over the other, from the diagonals.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "heidenhain-tnc/consumer.h"
#include "siemens-840d/consumer.h"
#include "workshop.h"

using namespace workshop;

namespace {

constexpr std::size_t n = 30;
constexpr double Lx = 12.0, Ly = 9.0, square = 8e-6;

double f(double x) { return 40 * um * std::sin(std::numbers::pi * x / Lx); }
double g(double y) { return -25 * um * std::sin(2.0 * std::numbers::pi * y / Ly); }

/// What the analysis of two diagonals says of a machine with f, g and squareness only.
Results::Analysed analysed(bool separable) {
  Results::Analysed a{"diagonal-straightness", "1.0.0", "D1", {}};
  Evaluation& e = a.evaluation;
  e.values.push_back({"C0Y", square, Quantity::small_angle});
  Series EYX{"EYX", "X", Quantity::length, Quantity::deviation, {}, {}, {}};
  Series EXY{"EXY", "Y", Quantity::length, Quantity::deviation, {}, {}, {}};
  PointTable::Column target{"target", Quantity::length, {}}, D1{"D1", Quantity::deviation, {}},
      D2{"D2", Quantity::deviation, {}};
  for (std::size_t i = 0; i <= n; ++i) {
    const double t = static_cast<double>(i) / n, x = Lx * t, y = Ly * t, down = Ly - y;
    EYX.position.push_back(x), EYX.value.push_back(f(x));
    EXY.position.push_back(y), EXY.value.push_back(g(y));
    target.values.push_back(15.0 * t);
    D1.values.push_back(0.8 * (g(y) - square * y) + 0.6 * f(x));
    D2.values.push_back(0.8 * (g(down) - square * (down - Ly)) - 0.6 * f(x));
  }
  e.points.columns = {target, D1, D2};
  if (separable) e.series = {EYX, EXY};
  return a;
}

Bench gantry() {
  Bench bench;
  for (const auto& [axis, length] : {std::pair{"X", Lx}, {"Y", Ly}})
    bench.add({.axis = axis,
               .id = axis,
               .targets = even(0.0, length / n, n + 1),
               .plus = [](double) { return 0.0; },
               .minus = [](double) { return 0.0; }});
  return bench;
}

TEST(Cross, SiemensTablesTakeStraightnessAndSquarenessAway) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(true));
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result) << result.error().message;
  const std::string text = file(*result, "siemens-840d-XY-CEC.ini");
  EXPECT_TRUE(contains(text, "$AN_CEC[0,15]=0.04\n")) << text;  // +e of Y at the middle of X
  EXPECT_TRUE(contains(text, "$AN_CEC[1,30]=-0.072\n"));        // -C0Y Ly of X at the end of Y
  EXPECT_TRUE(contains(text, "$AN_CEC_INPUT_AXIS[0]=(AX1)\n$AN_CEC_OUTPUT_AXIS[0]=(AX2)\n"));
  EXPECT_TRUE(contains(text, "$AN_CEC_INPUT_AXIS[1]=(AX2)\n$AN_CEC_OUTPUT_AXIS[1]=(AX1)\n"));
  const auto y = siemens::load_cross({text}, "AX1", "AX2", {});
  const auto x = siemens::load_cross({text}, "AX2", "AX1", {});
  ASSERT_TRUE(x && y);
  for (std::size_t i = 0; i <= n; ++i) {
    const double at = static_cast<double>(i) / n;
    EXPECT_NEAR((*y)(Lx * at, 1), -f(Lx * at), 2e-9);
    EXPECT_NEAR((*x)(Ly * at, -1), -(g(Ly * at) - square * Ly * at), 2e-9);
  }
  for (const char* diagonal : {"D1", "D2"}) {
    EXPECT_GT(prediction(*result, diagonal).before, 40 * um);
    EXPECT_LT(prediction(*result, diagonal).after, 0.01 * um);
  }
}

TEST(Cross, AFlippedSignIsSeenByTheConsumer) {
  Bench bench = gantry();
  auto wrong = analysed(true);
  for (Series& s : wrong.evaluation.series)
    for (double& v : s.value) v = -v;
  wrong.evaluation.values[0].value = -square;
  bench.results.analyses.push_back(wrong);
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result);
  EXPECT_GT(prediction(*result, "D1").after, 1.9 * prediction(*result, "D1").before);
  EXPECT_NE(finding(*result, "table.no-gain"), nullptr);
}

TEST(Cross, HeidenhainColumnsOfTheOtherAxis) {
  for (const char* layout : {"tnc640", "itnc530"}) {
    Bench bench = gantry();
    bench.results.analyses.push_back(analysed(true));
    const auto result = bench.write(heidenhain_plugin(), {{"layout", std::string(layout)}});
    ASSERT_TRUE(result) << result.error().message;
    const auto y = heidenhain::load(file(*result, "heidenhain-tnc-X.COM"), {"Y", false, 256, 0.0});
    const auto x = heidenhain::load(file(*result, "heidenhain-tnc-Y.COM"), {"X", false, 256, 0.0});
    ASSERT_TRUE(x && y) << layout;
    for (std::size_t i = 0; i <= n; ++i) {
      const double at = static_cast<double>(i) / n;
      EXPECT_NEAR((*y)(Lx * at, 1), -f(Lx * at), 0.051 * um);
      EXPECT_NEAR((*x)(Ly * at, 1), -(g(Ly * at) - square * Ly * at), 0.051 * um);
    }
    EXPECT_LT(prediction(*result, "D1").after, 0.3 * um);  // four decimals of a millimetre
    EXPECT_LT(prediction(*result, "D2").after, 0.3 * um);
  }
}

TEST(Cross, WhatIsNotSeparatedHasNoTable) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(false));
  const auto result = bench.write(siemens_plugin());
  ASSERT_TRUE(result);
  EXPECT_FALSE(has_file(*result, "siemens-840d-XY-CEC.ini"));
}

TEST(Cross, MorePointsThanTheControlTakesAreRefused) {
  Bench bench = gantry();
  bench.results.analyses.push_back(analysed(true));
  EXPECT_FALSE(bench.write(siemens_plugin(), {{"max_points", std::int64_t{20}}}));
}

}  // namespace
