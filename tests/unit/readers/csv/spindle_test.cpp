// SPDX-License-Identifier: Apache-2.0
// Records of a turning spindle: set-ups, index pulses, the sense of the angles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "csv.h"

namespace nonio::csv::spindle_test {
namespace {

Expected<Observations> read_text(const std::string& text) {
  Campaign campaign;
  Measurement m;
  m.id = "D1", m.kind = "spindle", m.file = "d1.csv";
  const Settings options;
  return read({text, campaign, m, options, {}});
}

TEST(Spindle, ASetUpIsALine) {
  const auto obs = read_text(
      "angle_deg,ball_deg,sensor_deg,x_um,y_um\n0,0,0,1,2\n90,0,0,3,nan\n0,180,180,5,6\n");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->lines.size(), 4U);
  EXPECT_EQ(obs->lines[2].name, "X ball 180 sensor 180");
  EXPECT_NEAR(obs->lines[2].sense[0], -1.0, 1e-12);  // it is on the other side
  EXPECT_NEAR(obs->lines[1].sense[1], 1.0, 1e-12);
  EXPECT_EQ(obs->size(), 5U);
  EXPECT_EQ(obs->missing, 1U);
  ASSERT_EQ(obs->axes.size(), 3U);
  EXPECT_NEAR(obs->axes[1].position.back(), std::numbers::pi, 1e-12);
}

TEST(Spindle, PulsesDivideATurnEvenly) {
  const auto obs = read_text("index,x_um\n0,9\n1,1\n0,2\n0,3\n0,4\n1,5\n0,6\n1,7\n0,8\n");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 7U);  // one before the first pulse, one after the final one
  ASSERT_EQ(obs->notes.size(), 1U);
  EXPECT_EQ(obs->notes[0].id, "csv.outside-pulses");
  EXPECT_NEAR(obs->axes[0].position[1], 2.0 * std::numbers::pi / 4.0, 1e-12);
  EXPECT_NEAR(obs->axes[0].position[5], 2.0 * std::numbers::pi * 1.5, 1e-12);
  for (const char* bad : {"index,x_um\n0.5,1\n", "x_um\n1\n", "angle_deg,x_um\n0,1\n0,2\n",
                          "angle_deg,x_um\n0,1\n90,2\n45,3\n", "angle_deg,x_um\n90,1\n0,2\n45,3\n",
                          "angle_deg\n1\n", "index,x_um\n0,1\n"})
    EXPECT_FALSE(read_text(bad)) << bad;
  const auto falling = read_text("angle_deg,x_um\n90,1\n45,2\n0,3\n");
  ASSERT_TRUE(falling) << falling.error().message;
  EXPECT_NEAR(falling->axes[0].position[2] - falling->axes[0].position[0], std::numbers::pi / 2.0,
              1e-12);
}

}  // namespace
}  // namespace nonio::csv::spindle_test
