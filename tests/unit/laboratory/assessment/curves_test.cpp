// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/curves.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace nonio::test::curves_test {
namespace {
namespace fs = std::filesystem;

TEST(WorklistCurves, AreThoseOfTheResults) {
  const fs::path out = fs::temp_directory_path() / ("nonio-curves-" + std::to_string(::getpid()));
  const auto write = [&](const std::string& campaign, const std::string& text) {
    fs::create_directories(out / campaign);
    std::ofstream(out / campaign / "results.json") << text;
  };
  write("b", R"({"analyses": [
    {"plugin": "iso230-2", "measurement": "X1", "point_units": {"target": "mm", "mean": "um"},
     "points": [{"target": 10.5, "mean": -1.25}, {"target": 500.0, "mean": 2.5}, {"target": 600.0}],
     "point_U": {"mean": 3.0}},
    {"plugin": "vdi-dgq-3441", "measurement": "X1", "point_units": {"target": "mm", "mean": "um"},
     "points": [{"target": 10.5, "mean": 9.0}]},
    {"plugin": "diagonals", "measurement": "D1", "values": {}}],
    "followed": [{"measurement": "X1", "axis": "X"}]})");
  write("a",
        R"({"analyses": [{"measurement": "C", "point_units": {"target": "deg", "mean": "arcsec"},
     "points": [{"target": 90.0, "mean": 3.6}]}], "followed": [{"measurement": "C", "axis": "C"}]})");
  write("cut", R"({"analyses": [{"measurement": "C")");
  reports::MachineHistory machine;
  machine.series.resize(1);
  for (const auto& [campaign, day] : {std::pair("b", "2025-01-02"),
                                      {"a", "2024-01-02"},
                                      {"cut", "2024-02-02"},
                                      {"gone", "2024-03-02"}})
    machine.series[0].points.push_back({campaign, day, ""});
  const auto curves = assessment::curves_of(out, machine);
  fs::remove_all(out);
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_EQ(curves[0].campaign + curves[0].axis + curves[0].date, "aC2024-01-02");
  EXPECT_TRUE(curves[0].rotary);
  EXPECT_NEAR(curves[0].position[0], 1.5707963, 1e-6);
  EXPECT_NEAR(curves[0].mean[0], 3.6 / 206264.806, 1e-12);
  EXPECT_EQ(curves[1].axis, "X");
  ASSERT_EQ(curves[1].mean.size(), 2U);
  EXPECT_DOUBLE_EQ(curves[1].position[1], 0.5);
  EXPECT_DOUBLE_EQ(curves[1].mean[0], -1.25e-6);
  EXPECT_DOUBLE_EQ(curves[1].u, 1.5e-6);
}

}  // namespace
}  // namespace nonio::test::curves_test
