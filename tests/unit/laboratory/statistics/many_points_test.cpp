// SPDX-License-Identifier: Apache-2.0
// Many points: charts and segmentations of the literature, and whether trend_of says the same.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "laboratory/statistics/gls.h"
#include "laboratory/statistics/trend.h"
#include "made.h"
#include "nile.h"
#include "oracles.h"

namespace nonio::statistics::many_points_test {
namespace {

Series at_equal_times(const std::vector<double>& x, double u) {
  Series s;
  for (std::size_t i = 0; i < x.size(); ++i) s.points.push_back({static_cast<double>(i), x[i], u});
  return s;
}

std::vector<double> river() { return {std::begin(nile), std::end(nile)}; }

double chi2_of(const Series& s, std::optional<std::size_t> after) {
  const Whitened w(s);
  MatrixXd X(static_cast<Index>(s.points.size()), after ? 2 : 1);
  X.col(0) = w.column(VectorXd::Ones(X.rows()));
  if (after) {
    VectorXd step = VectorXd::Zero(X.rows());
    step.tail(X.rows() - static_cast<Index>(*after) - 1).setOnes();
    X.col(1) = w.column(step);
  }
  return gls(w, X)->chi2;
}

TEST(ManyPoints, OneChangeOfTheNile) {
  const auto x = river();
  double sum = 0.0;
  for (const double v : x) sum += v;
  ASSERT_EQ(sum, 91935.0);
  const Series s = at_equal_times(x, 1.0);
  const double level = chi2_of(s, {}), step = chi2_of(s, 27);
  EXPECT_NEAR(level, 2835156.75, 6e-3);
  EXPECT_NEAR(step, 1597457.1944, 6e-5);
  const double F = (level - step) / (step / 98.0);
  EXPECT_NEAR(F, 75.92977, 6e-6);
  EXPECT_NEAR(std::sqrt(F), 8.71377, 6e-6);
  for (std::size_t k = 0; k + 1 < x.size(); ++k) EXPECT_GE(chi2_of(s, k), step) << k;
}

TEST(ManyPoints, TheNileIsCutWhereOthersCutIt) {
  const auto x = river();
  const double variance = 16300.58, ln_n = std::log(100.0);
  for (const double penalty : {2.0, 3.0, 4.0})
    EXPECT_EQ(oracle::best_segments(x, variance, penalty * ln_n), std::vector<std::size_t>{28});
  const oracle::Pettitt p = oracle::pettitt(x);
  EXPECT_EQ(p.K, 1617.0);
  EXPECT_EQ(p.before, 28U);
  EXPECT_NEAR(p.p, 3.59e-7, 6e-10);
  const auto t = trend_of(at_equal_times(x, std::sqrt(variance)));
  ASSERT_TRUE(t);
  EXPECT_EQ(t->model, Model::step);
  ASSERT_EQ(t->changes.size(), 1U);
  EXPECT_EQ(t->changes[0].after, 27U);
  EXPECT_NEAR(t->segments[0].last, 1097.75, 6e-3);
  EXPECT_NEAR(t->segments[1].last, 849.9722, 6e-5);
}

TEST(ManyPoints, ALineHasALargeStepToo) {
  const Series s = reference_series();
  const double level = chi2_of(s, {});
  double most = 0.0;
  std::size_t where = 0;
  for (std::size_t k = 0; k + 1 < s.points.size(); ++k)
    if (const double G = level - chi2_of(s, k); G > most) most = G, where = k;
  EXPECT_NEAR(most, 30.73, 6e-3);
  EXPECT_EQ(where + 1, 4U);
  const Whitened w(s);
  MatrixXd X(8, 2);
  X.col(0) = w.column(VectorXd::Ones(8));
  X.col(1) = w.column((VectorXd(8) << 0, 0, 0, 0, 1, 1, 1, 1).finished());
  const auto fit = gls(w, X);
  EXPECT_NEAR(fit->b(1), -0.926, 6e-4);
  EXPECT_NEAR(std::sqrt(fit->C(1, 1)), 0.167, 6e-4);
}

// NIST/SEMATECH handbook, 6.3.2.
TEST(ManyPoints, TheHandbooksEwma) {
  const std::vector<double> x{52.0, 47.0, 53.0, 49.3, 50.1, 47.0, 51.0, 50.1, 51.2, 50.5,
                              49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4, 53.6, 52.1},
      z{50.60, 49.52, 50.56, 50.18, 50.16, 49.21, 49.75, 49.85, 50.26, 50.33,
        50.11, 49.36, 49.52, 50.05, 49.38, 49.92, 50.73, 51.23, 51.94, 51.99};
  const auto found = oracle::ewma(x, 50.0, 0.3);
  for (std::size_t i = 0; i < z.size(); ++i) EXPECT_NEAR(found[i], z[i], 5.1e-3) << i;
  EXPECT_NEAR(50.0 + 3.0 * 2.0539 * std::sqrt(0.3 / 1.7), 52.5884, 6e-5);
  EXPECT_NEAR(50.0 - 3.0 * 2.0539 * std::sqrt(0.3 / 1.7), 47.4116, 6e-5);
  // No alarm, and no news.
  EXPECT_EQ(std::count_if(found.begin(), found.end(), [](double v) { return v > 52.5884; }), 0);
  EXPECT_NE(trend_of(at_equal_times(x, 2.0539))->model, Model::step);
}

TEST(ManyPoints, TheHandbooksCusum) {
  const std::vector<double> x{324.925, 324.675, 324.725, 324.350, 325.350, 325.225, 324.125,
                              324.525, 325.225, 324.600, 324.625, 325.150, 328.325, 327.250,
                              327.825, 328.500, 326.675, 327.775, 326.875, 328.350};
  const auto c = oracle::cusum(x, 325.0, 0.3175);
  EXPECT_NEAR(c.upper[12], 3.0075, 6e-5);
  EXPECT_NEAR(c.upper[13], 4.9400, 6e-5);
  EXPECT_NEAR(c.upper[19], 19.0350, 6e-5);
  const auto alarm =
      std::find_if(c.upper.begin(), c.upper.end(), [](double s) { return s > 4.1959; });
  EXPECT_EQ(alarm - c.upper.begin() + 1, 14);
  EXPECT_NEAR(*std::max_element(c.lower.begin(), c.lower.end()), 0.7150, 6e-5);
  // The same change, and since when.
  const auto t = trend_of(at_equal_times(x, 0.635));
  ASSERT_TRUE(t);
  ASSERT_EQ(t->changes.size(), 1U);
  EXPECT_EQ(t->changes[0].after, 11U);
}

}  // namespace
}  // namespace nonio::statistics::many_points_test
