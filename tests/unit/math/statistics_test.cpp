// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nonio::math::statistics_test {
namespace {

// NIST Statistical Reference Datasets, univariate: NumAcc1..4, made to break one-pass formulas.
// https://www.itl.nist.gov/div898/strd/univ/homepage.html: certified means and deviations.
TEST(Statistics, NistNumAcc1) {
  const std::vector<double> x = {10000001, 10000003, 10000002};
  EXPECT_EQ(mean(x), 10000002.0);
  EXPECT_EQ(standard_deviation(x), 1.0);
}

std::vector<double> num_acc(double middle, double low, double high) {
  std::vector<double> x = {middle};
  for (int k = 0; k < 500; ++k) {
    x.push_back(low);
    x.push_back(high);
  }
  return x;
}

TEST(Statistics, NistNumAcc2To4) {
  const auto second = num_acc(1.2, 1.1, 1.3);
  EXPECT_NEAR(mean(second), 1.2, 1e-15);
  EXPECT_NEAR(standard_deviation(second), 0.1, 1e-14);
  const auto third = num_acc(1000000.2, 1000000.1, 1000000.3);
  EXPECT_NEAR(mean(third), 1000000.2, 1e-9);
  EXPECT_NEAR(standard_deviation(third), 0.1, 1e-9);
  const auto fourth = num_acc(10000000.2, 10000000.1, 10000000.3);
  EXPECT_NEAR(mean(fourth), 10000000.2, 1e-8);
  EXPECT_NEAR(standard_deviation(fourth), 0.1, 1e-8);
}

TEST(Statistics, MedianAndRobustDeviation) {
  EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2.0);
  EXPECT_EQ(median(std::vector<double>{4, 1, 2, 3}), 2.5);
  // Deviations from 3: 2 1 0 1 97; their median is 1. The factor is 1/0.674489750196082.
  EXPECT_NEAR(robust_deviation(std::vector<double>{1, 2, 3, 4, 100}), 1.482602218505602, 1e-15);
  EXPECT_NEAR(0.5 * std::erfc(-1.0 / robust_deviation(std::vector<double>{1, 2, 3, 4, 100}) /
                              std::sqrt(2.0)),
              0.75, 1e-15);
}

TEST(Statistics, TooFewValues) {
  EXPECT_TRUE(std::isnan(mean({})));
  EXPECT_TRUE(std::isnan(standard_deviation(std::vector<double>{1})));
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(robust_deviation({})));
  EXPECT_TRUE(std::isnan(median(std::vector<double>{1, std::nan(""), 2})));
}

}  // namespace
}  // namespace nonio::math::statistics_test
