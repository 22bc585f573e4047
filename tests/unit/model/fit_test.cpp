// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "nonio/sdk/axis_readings.h"

namespace nonio::model::fit_test {

namespace {

/// d = zero + a x with the columns x and, for an alias, 2 x.
Effect line_effect(bool alias) {
  Effect e;
  e.info = {alias ? "double" : "line", "1", "", {}};
  e.linear = {{"a", "", Quantity::number}};
  e.columns = alias ? [](const Observations& o, const Axis&,
                         const std::vector<double>&) -> Expected<std::vector<std::vector<double>>> {
    std::vector<double> x = o.axes[0].position;
    for (double& v : x) v *= 2.0;
    return std::vector<std::vector<double>>{x};
  }
  : [](const Observations& o, const Axis&,
       const std::vector<double>&) -> Expected<std::vector<std::vector<double>>> {
      return std::vector<std::vector<double>>{o.axes[0].position};
    };
  return e;
}

Observations points(std::vector<double> x, std::vector<double> y) {
  Observations o;
  o.axes = {{"X", false, std::move(x), {}}};
  o.lines = {{"1", {1, 0, 0}}};
  o.deviation = std::move(y);
  return o;
}

}  // namespace

// x = 0..4, y = 1, 3, 2, 5, 4: by hand slope 4/5, intercept 7/5, residual sum of squares 18/5,
// s^2 = 6/5, u(a) = sqrt(s^2/10) = sqrt(3/25).
TEST(Fit, StraightLineByHand) {
  const Effect line = line_effect(false);
  const auto f = fit(points({0, 1, 2, 3, 4}, {1, 3, 2, 5, 4}), {{&line, Axis{.name = "X"}}});
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_EQ(f->parameters[0].effect, "line:X");
  EXPECT_EQ(f->parameters[0].name, "a");
  EXPECT_NEAR(f->parameters[0].value, 0.8, 1e-14);
  EXPECT_NEAR(f->zero[0], 1.4, 1e-14);
  EXPECT_NEAR(f->parameters[0].u, std::sqrt(0.12), 1e-14);
  EXPECT_NEAR(f->rms, std::sqrt(3.6 / 5.0), 1e-14);
  EXPECT_EQ(f->redundancy, 3u);
}

// y = 0, 1, 5 at x = 0, 1, 2 with u = 1, 1, 2. A reading without u counts as one of the mean u.
TEST(Fit, AReadingCountsByItsUncertainty) {
  const Effect line = line_effect(false);
  Observations o = points({0, 1, 2}, {0, 1, 5});
  o.u = {1.0, 1.0, 2.0};
  // sums of w = 4, 4, 1: w 9, wx 6, wxx 8, wy 9, wxy 14; slope (9*14 - 6*9)/(9*8 - 36) = 2,
  // intercept (9 - 12)/9.
  const auto f = fit(o, {{&line, Axis{.name = "X"}}});
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_NEAR(f->parameters[0].value, 2.0, 1e-12);
  EXPECT_NEAR(f->zero[0], -1.0 / 3.0, 1e-12);
  o.u = {1.0, 3.0, std::nan("")};
  const auto g = fit(o, {{&line, Axis{.name = "X"}}});
  o.u = {1.0, 3.0, 2.0};
  const auto h = fit(o, {{&line, Axis{.name = "X"}}});
  ASSERT_TRUE(g && h);
  EXPECT_NEAR(g->parameters[0].value, h->parameters[0].value, 1e-12);
}

// Without measured times a drift is in um per reading, not in um/h.
TEST(Fit, TimesThatWereNotMeasuredAreNotHours) {
  Effect drift = line_effect(false);
  drift.linear = {{"z", "", Quantity::deviation_per_time, Quantity::angle_per_time}};
  Observations o = points({0, 1, 2, 3, 4}, {1, 3, 2, 5, 4});
  o.axes[0].approach.assign(5, 1);
  auto f = fit(o, {{&drift, Axis{.name = "X"}}});
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_EQ(unit_of(f->parameters[0].quantity).symbol, "um/reading");
  o.time = {0, 10, 20, 30, 40};
  f = fit(o, {{&drift, Axis{.name = "X"}}});
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_EQ(unit_of(f->parameters[0].quantity).symbol, "um/h");
  o.time[3] = std::nan("");  // not all of them
  f = fit(o, {{&drift, Axis{.name = "X"}}});
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_EQ(unit_of(f->parameters[0].quantity).symbol, "um/reading");
}

namespace {

/// 41 readings, a minute apart, of a growth with the temperature, one in four of them without one.
Observations with_blanks(const std::function<double(double)>& kelvin, bool blank) {
  Observations o = points({}, {});
  for (int i = 0; i < 41; ++i) {
    const double t = 60.0 * i, noise = ((i * 37) % 41 - 20) / 20.0;
    o.axes[0].position.push_back(0.01 * ((i * 7) % 41));
    o.axes[0].approach.push_back(1);
    o.time.push_back(t);
    o.material.push_back(blank && i % 4 == 1 ? std::nan("") : 20.0 + kelvin(t));
    o.deviation.push_back(1e-6 * (10.0 * kelvin(t) + noise));
  }
  return o;
}

Effect growth() {
  Effect e;
  e.info = {"growth", "1", "", {}};
  e.linear = {{"a", "", Quantity::number}};
  e.columns = [](const Observations& o, const Axis& axis, const std::vector<double>&) {
    return columns_of(o, axis, [](const AxisReadings& r, std::size_t i) { return r.K[i]; });
  };
  return e;
}

double u_of_growth(const Observations& o) {
  const Effect effect = growth();
  const auto f = fit(o, {{&effect, Axis{.name = "X"}}});
  EXPECT_TRUE(f) << f.error().message;
  return f ? f->parameters[0].u : -1.0;
}

}  // namespace

TEST(Fit, UHoldsWhatInterpolatedTemperaturesMayBeOff) {
  const auto swings = [](double t) { return std::sin(t / 90.0); };
  const auto steady = [](double t) { return t / 600.0; };
  // Readings between known temperatures are off by more than the noise says: seen where known.
  const Observations rough = with_blanks(swings, true);
  std::vector<double> weight(rough.size(), 1.0);
  for (std::size_t i = 0; i < rough.size(); ++i) weight[i] = std::isfinite(rough.material[i]);
  const Effect effect = growth();
  const auto known = fit(with_blanks(swings, false), {{&effect, Axis{.name = "X"}}}, weight);
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_GT(u_of_growth(rough), 1.5 * known->parameters[0].u);
  // A straight line in time is right everywhere.
  EXPECT_NEAR(u_of_growth(with_blanks(steady, true)), u_of_growth(with_blanks(steady, false)),
              1e-3 * u_of_growth(with_blanks(steady, false)));
}

TEST(Fit, EachLineHasItsOwnZero) {
  const Effect line = line_effect(false);
  Observations o = points({0, 1, 2, 0, 1, 2}, {10, 11, 12, -5, -4, -3});
  o.lines.push_back({"2", {1, 0, 0}});
  o.line = {0, 0, 0, 1, 1, 1};
  const auto f = fit(o, {{&line, Axis{.name = "X"}}});
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->parameters[0].value, 1.0, 1e-13);
  EXPECT_NEAR(f->zero[0], 10.0, 1e-13);
  EXPECT_NEAR(f->zero[1], -5.0, 1e-13);
}

TEST(Fit, InseparableParametersAreNamedNotGuessed) {
  const Effect line = line_effect(false), alias = line_effect(true);
  const auto f = fit(points({0, 1, 2, 3}, {0, 1, 2, 4}),
                     {{&line, Axis{.name = "X"}}, {&alias, Axis{.name = "X"}}});
  ASSERT_FALSE(f);
  EXPECT_NE(f.error().message.find("line:X, double:X"), std::string::npos) << f.error().message;
}

TEST(Fit, TooFewReadings) {
  const Effect line = line_effect(false);
  EXPECT_FALSE(fit(points({0, 1}, {0, 1}), {{&line, Axis{.name = "X"}}}));
}

}  // namespace nonio::model::fit_test
