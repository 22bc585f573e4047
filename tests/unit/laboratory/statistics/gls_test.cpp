// SPDX-License-Identifier: Apache-2.0
// Generalised least squares with what campaigns have in common: values recomputed with numpy.
#include "laboratory/statistics/gls.h"

#include <gtest/gtest.h>

#include "made.h"
#include "nonio/math/distributions.h"

namespace nonio::statistics::gls_test {
namespace {

MatrixXd line(const Series& s, const Whitened& w) {
  MatrixXd X(static_cast<Index>(s.points.size()), 2);
  X.col(0).setOnes();
  for (Index i = 0; i < X.rows(); ++i) X(i, 1) = s.points[static_cast<std::size_t>(i)].time;
  X.col(0) = w.column(X.col(0));
  X.col(1) = w.column(X.col(1));
  return X;
}

struct Expected5 {
  double b0, b1, u0, u1, chi2, p, at, u_at;
};

void expect(const Series& s, const Expected5& e) {
  const Whitened w(s);
  const auto fit = gls(w, line(s, w));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->b(0), e.b0, 6e-6);
  EXPECT_NEAR(fit->b(1), e.b1, 6e-6);
  EXPECT_NEAR(std::sqrt(fit->C(0, 0)), e.u0, 6e-6);
  EXPECT_NEAR(std::sqrt(fit->C(1, 1)), e.u1, 6e-6);
  EXPECT_NEAR(fit->chi2, e.chi2, 6e-5);
  EXPECT_EQ(fit->dof, 6.0);
  EXPECT_NEAR(math::chi2_upper(fit->chi2, fit->dof), e.p, 6e-5);
  const Eigen::Vector2d x(1.0, 4.5);
  EXPECT_NEAR(x.dot(fit->b), e.at, 6e-5);
  EXPECT_NEAR(std::sqrt(x.dot(fit->C * x)), e.u_at, 6e-5);
}

TEST(Gls, IndependentPoints) {
  expect(reference_series(),
         {-4.07657, -0.42385, 0.16354, 0.07140, 2.2180, 0.8986, -5.9839, 0.1973});
}

TEST(Gls, WhatAllHaveInCommonMovesTheLevelOnly) {
  Series s = reference_series();
  for (Point& p : s.points) p.common = {{"instrument 1", 0.30}};
  expect(s, {-4.07657, -0.42385, 0.34168, 0.07140, 2.2180, 0.8986, -5.9839, 0.3591});
}

TEST(Gls, TwoInstruments) {
  Series s = reference_series();
  for (std::size_t i = 0; i < 8; ++i)
    s.points[i].common = {{i < 4 ? "instrument 1" : "instrument 2", 0.30}};
  expect(s, {-4.19257, -0.35534, 0.31080, 0.11733, 1.6766, 0.9469, -5.7916, 0.3901});
}

TEST(Gls, CampaignsThatScatterMore) {
  Series s = reference_series();
  s.excess = 2.0;
  expect(s, {-4.07657, -0.42385, 2 * 0.163538, 2 * 0.071404, 2.2180 / 4, 0.99711, -5.9839,
             2 * 0.19730});
}

TEST(Gls, ColumnsThatAreTheSameAreRefused) {
  const Series s = reference_series();
  const Whitened w(s);
  MatrixXd X = line(s, w);
  X.col(1) = X.col(0);
  EXPECT_FALSE(gls(w, X));
}

}  // namespace
}  // namespace nonio::statistics::gls_test
