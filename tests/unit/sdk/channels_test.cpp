// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/channels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nonio {
namespace {

Observations::Channel channel(std::vector<double> time, std::vector<double> value) {
  return {"t1", "degC", std::move(time), std::move(value)};
}

/// A ramp x = s t from 0 on: y = s (t - tau (1 - exp(-t/tau))).
TEST(Lagged, OfARampIsTheAnalyticAnswer) {
  std::vector<double> time, value;
  for (int i = 0; i <= 40; ++i) time.push_back(7.0 * i), value.push_back(20.0 + 0.25 * 7.0 * i);
  const double tau = 33.0;
  const auto y = lagged(channel(time, value), tau, time);
  for (std::size_t i = 0; i < time.size(); ++i)
    EXPECT_NEAR(y[i], 0.25 * (time[i] - tau * (1.0 - std::exp(-time[i] / tau))), 1e-12);
}

TEST(Lagged, WithoutLagIsTheChannelLessItsFirstValue) {
  const auto y = lagged(channel({0.0, 10.0, 20.0}, {5.0, 7.0, 4.0}), 0.0, {0.0, 5.0, 10.0, 20.0});
  EXPECT_EQ(y, (std::vector<double>{0.0, 1.0, 2.0, -1.0}));
}

/// Readings before and after the samples, and in another order than time.
TEST(Lagged, OutsideTheSamplesTheChannelStays) {
  const auto c = channel({0.0, 10.0}, {0.0, 1.0});
  const auto y = lagged(c, 10.0, {1e4, -5.0, 10.0, 0.0});
  EXPECT_NEAR(y[0], 1.0, 1e-12);
  EXPECT_EQ(y[1], 0.0);
  EXPECT_NEAR(y[2], std::exp(-1.0), 1e-12);  // of the ramp: 1 - tau/10 (1 - exp(-1))
  EXPECT_EQ(y[3], 0.0);
}

TEST(Lagged, SamplesOnceMoreChangeNothing) {
  const auto rough = channel({0.0, 40.0}, {0.0, 4.0});
  const auto fine = channel({0.0, 10.0, 25.0, 40.0}, {0.0, 1.0, 2.5, 4.0});
  EXPECT_NEAR(lagged(rough, 12.0, {40.0})[0], lagged(fine, 12.0, {40.0})[0], 1e-12);
}

TEST(TimeConstants, LieBetweenTheSamplingAndTheDuration) {
  for (const auto& [hours, longest] : {std::pair{4.0, 1.0}, {20.0, 2.0}, {48.0, 4.0}}) {
    std::vector<double> time;
    for (int i = 0; i <= 1000; ++i) time.push_back(3.6 * hours * i);
    const auto all = time_constants_for(time);
    ASSERT_GE(all.size(), 3U);
    EXPECT_EQ(all.front(), 0.0);
    EXPECT_GE(all[1], 4.0 * 3.6 * hours);
    EXPECT_NEAR(all.back(), 3600.0 * longest, 1e-9) << hours;
  }
  EXPECT_TRUE(time_constants_for({0.0, 1.0, 2.0}).empty());
}

}  // namespace
}  // namespace nonio
