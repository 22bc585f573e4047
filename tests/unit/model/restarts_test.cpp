// SPDX-License-Identifier: Apache-2.0
// Interrupted displacements over time, and thermometers that fail.
#include "data/restarts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "data/failed_channels.h"

namespace nonio::model::restarts_test {

namespace {

constexpr double interval = 15.0;  // s

struct Noise {
  unsigned seed = std::random_device{}();
  std::mt19937 of{seed};
  double operator()(double s) { return std::normal_distribution<>(0.0, s)(of); }
};

/// A warm-up of 40 um with a time constant of an hour, read for five hours.
Part warm_up(Noise& noise, double tau = 3600.0, double s = 0.05e-6) {
  Part part;
  part.kind = Part::Kind::course;
  part.displacement = "z";
  part.table.lines = {{"Z", {}}};
  for (int i = 0; i < 1200; ++i) {
    const double t = interval * i, warm = std::max(0.0, t - 1500.0);
    part.table.time.push_back(t);
    part.table.deviation.push_back(-40e-6 * std::expm1(-warm / tau) + noise(s));
  }
  return part;
}

void shift(Part& part, std::size_t from, double by) {
  for (std::size_t i = from; i < part.table.size(); ++i) part.table.deviation[i] += by;
}

void drop(Part& part, std::size_t from, std::size_t to) {
  std::vector<char> kept(part.table.size(), 1);
  for (std::size_t i = from; i < to; ++i) kept[i] = 0;
  keep_rows(part.table, kept);
}

TEST(Restarts, AJumpOfTheSensorIsFoundWithItsTimeAndSize) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  for (const double jump : {12e-6, -5e-6}) {
    Part part = warm_up(noise);
    EXPECT_TRUE(restarts_of(part).empty());
    shift(part, 700, jump);
    const auto found = restarts_of(part);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].to, 700 * interval);
    EXPECT_EQ(found[0].displacement, "z");
    EXPECT_NEAR(found[0].jump, jump, 0.5e-6);
  }
  Part averaged = warm_up(noise, 3600.0, 0.02e-6);
  shift(averaged, 700, 12e-6);
  averaged.table.deviation[700] -= 7e-6;
  const auto found = restarts_of(averaged);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].to, 701 * interval) << "5 of 12 um: closer to the readings before";
  EXPECT_NEAR(found[0].jump, 12e-6, 0.5e-6);
}

TEST(Restarts, WhatAMachineOrADigitCanDoIsNoJump) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  EXPECT_TRUE(restarts_of(warm_up(noise, 0.6 * interval)).empty());
  Part outlier = warm_up(noise);
  outlier.table.deviation[700] += 12e-6;
  EXPECT_TRUE(restarts_of(outlier).empty());
  Part coarse = warm_up(noise, 3600.0, 0.0);
  for (double& d : coarse.table.deviation) d = 4e-6 * std::round(d / 4e-6);
  EXPECT_TRUE(restarts_of(coarse).empty());
  Part spindle = warm_up(noise);
  shift(spindle, 700, 12e-6);
  Observations::Channel speed{"spindle", "rpm", spindle.table.time, {}};
  for (std::size_t i = 0; i < spindle.table.size(); ++i) speed.value.push_back(i < 700 ? 0 : 9000);
  spindle.table.channels = {speed};
  EXPECT_TRUE(restarts_of(spindle).empty());
  Part switched = warm_up(noise);
  for (std::size_t i = 500; i < 1100; i += 100) shift(switched, i, i % 200 == 0 ? 9e-6 : -9e-6);
  EXPECT_TRUE(restarts_of(switched).empty());
}

TEST(Restarts, AGapSeparatesReadingsButBurstsDoNot) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  Part part = warm_up(noise);
  shift(part, 650, 3e-6);
  drop(part, 600, 760);
  const auto found = restarts_of(part);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].from, 599 * interval);
  EXPECT_EQ(found[0].to, 760 * interval);
  EXPECT_EQ(found[0].displacement, "");
  shift(part, 300, 12e-6);
  put_restarts(part, restarts_of(part));
  EXPECT_EQ(part.restarts.size(), 2U);
  EXPECT_EQ(part.table.lines.size(), 3U);
  EXPECT_EQ(part.table.line_of(299), 0U);
  EXPECT_EQ(part.table.line_of(300), 1U);
  EXPECT_EQ(part.table.line_of(599), 1U);
  EXPECT_EQ(part.table.line_of(600), 2U);
  Part bursts = warm_up(noise);
  for (std::size_t i = 1; i < bursts.table.size(); ++i)
    bursts.table.time[i] = bursts.table.time[i - 1] + (i % 20 == 0 ? 3581.0 : 1.0);
  EXPECT_TRUE(restarts_of(bursts).empty());
  Part short_gap = warm_up(noise);
  drop(short_gap, 600, 608);
  EXPECT_TRUE(restarts_of(short_gap).empty());
}

/// Four thermometers that move by several kelvins, read to 0.01 K.
Part thermometers(Noise& noise) {
  Part part = warm_up(noise);
  for (int k = 0; k < 4; ++k) {
    Observations::Channel c{"t" + std::to_string(k), "degC", part.table.time, {}};
    for (const double t : c.time)
      c.value.push_back(0.01 * std::round(100.0 * (22.0 + 3.0 * std::sin(t / (1500.0 + 400.0 * k)) +
                                                   noise(0.02))));
    part.table.channels.push_back(std::move(c));
  }
  return part;
}

TEST(FailedChannels, AFrozenThermometerIsLeftOut) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  Part part = thermometers(noise);
  leave_failed(part);
  EXPECT_TRUE(part.channels_left.empty());
  auto& value = part.table.channels[2].value;
  std::fill(value.begin() + 500, value.begin() + 900, value[500]);
  Part still = part;
  leave_failed(part);
  ASSERT_EQ(part.channels_left.size(), 1U);
  EXPECT_EQ(part.channels_left[0].name, "t2");
  EXPECT_EQ(part.channels_left[0].why, ChannelLeft::Why::frozen);
  EXPECT_NEAR(part.channels_left[0].from, 500 * interval, 3 * interval);
  EXPECT_NEAR(part.channels_left[0].to, 899 * interval, 3 * interval);
  EXPECT_EQ(part.table.channel("t2"), nullptr);
  EXPECT_EQ(part.table.channels.size(), 3U);
  // Another one that hardly moves at that time: both may be on a body that keeps its temperature.
  auto& other = still.table.channels[0].value;
  for (std::size_t i = 500; i < 900; ++i) other[i] = other[500] + 0.01 * std::round(noise(1.0));
  leave_failed(still);
  EXPECT_TRUE(still.channels_left.empty());
}

TEST(FailedChannels, ACoarseThermometerAtAConstantTemperatureIsKept) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  Part part = thermometers(noise);
  auto& value = part.table.channels[1].value;
  for (std::size_t i = 0; i < value.size(); ++i)
    value[i] = 20.0 + 0.5 * std::floor(static_cast<double>(i) / 400.0);
  leave_failed(part);
  EXPECT_TRUE(part.channels_left.empty());
}

TEST(FailedChannels, ValuesAfterPowerOnAreMissing) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  Part part = thermometers(noise);
  auto& value = part.table.channels[1].value;
  value[0] = 85.0;
  value[300] = value[301] = -127.0;
  for (std::size_t i = 0; i < part.table.channels[3].value.size(); ++i)
    part.table.channels[3].value[i] =
        0.1 * std::round(60.0 * std::sin(static_cast<double>(i) / 90));
  auto& fails = part.table.channels[0].value;
  std::fill(fails.begin() + 700, fails.end(), 0.0);
  leave_failed(part);
  ASSERT_EQ(part.channels_left.size(), 2U) << "0 degC between -0.1 and 0.1 degC is a temperature";
  EXPECT_EQ(part.channels_left[0].name, "t0");
  EXPECT_EQ(part.channels_left[0].why, ChannelLeft::Why::start_value);
  EXPECT_EQ(part.channels_left[0].readings, 500U);
  EXPECT_EQ(part.channels_left[1].name, "t1");
  EXPECT_EQ(part.channels_left[1].why, ChannelLeft::Why::start_values_dropped);
  EXPECT_EQ(part.channels_left[1].readings, 3U);
  EXPECT_EQ(part.table.channel("t0"), nullptr);
  const auto* kept = part.table.channel("t1");
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->value.size(), 1197U);
  EXPECT_LT(*std::max_element(kept->value.begin(), kept->value.end()), 30.0);
  EXPECT_GT(*std::min_element(kept->value.begin(), kept->value.end()), 15.0);
}

TEST(FailedChannels, SpikesAreMissing) {
  Noise noise;
  SCOPED_TRACE("seed " + std::to_string(noise.seed));
  Part part = thermometers(noise);
  const std::vector<double> before = part.table.channels[1].value;
  auto& spikes = part.table.channels[1].value;
  spikes[0] += 8.0, spikes[400] += 3.0, spikes[800] -= 12.0, spikes.back() -= 5.0;
  auto& steps = part.table.channels[2].value;
  for (std::size_t i = 600; i < steps.size(); ++i) steps[i] += 6.0;  // a step is no spike
  leave_failed(part);
  ASSERT_EQ(part.channels_left.size(), 1U);
  EXPECT_EQ(part.channels_left[0].why, ChannelLeft::Why::spikes_dropped);
  EXPECT_EQ(part.channels_left[0].readings, 4U);
  EXPECT_EQ(part.channels_left[0].value, before[800] - 12.0);
  EXPECT_FALSE(part.channels_left[0].fails());
  EXPECT_EQ(part.table.channel("t1")->value.size(), before.size() - 4);
  // Where the displacement moves as well, something happened.
  Part splashed = thermometers(noise);
  for (const std::size_t at : {400, 800}) {
    splashed.table.channels[1].value[at] -= 8.0;
    splashed.table.deviation[at] += 2e-6;
  }
  leave_failed(splashed);
  EXPECT_TRUE(splashed.channels_left.empty());
}

}  // namespace

}  // namespace nonio::model::restarts_test
