// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "one_output.h"

namespace nonio {
namespace {

Campaign campaign_of(std::vector<Measurement> measurements) {
  Campaign c;
  c.id = "c-1";
  c.measurements = std::move(measurements);
  return c;
}

Measurement measurement(const std::string& id) {
  Measurement m;
  m.id = id;
  m.kind = "axis";
  m.axis = "X";
  m.file = "x.csv";
  return m;
}

Observations two_readings() {
  Observations o;
  o.axes.push_back({"X", false, {0.0252, 0.1}, {1, -1}});
  o.lines.push_back({"X", {1, 0, 0}});
  o.deviation = {1.5e-6, -2e-6};
  o.run = {1, 2};
  o.source_line = {2, 3};
  o.time = {0.5, std::numeric_limits<double>::quiet_NaN()};
  o.missing = 3;
  o.notes = {{.id = "x", .english = "a \"note\"\n"}};
  return o;
}

nlohmann::json parsed(const Expected<OutputResult>& result) {
  EXPECT_TRUE(result);
  EXPECT_EQ(result->artifacts.size(), 1U);
  EXPECT_EQ(result->artifacts[0].name, "readings.json");
  return nlohmann::json::parse(result->artifacts[0].bytes);
}

TEST(Json, ColumnsInPrintedUnits) {
  const auto json = parsed(written(campaign_of({measurement("X")}), {two_readings()}, {}));
  EXPECT_EQ(json["schema"], "nonio-readings/1");
  EXPECT_EQ(json["campaign"], "c-1");
  const auto& m = json["measurements"][0];
  EXPECT_EQ(m["id"], "X");
  EXPECT_EQ(m["kind"], "axis");
  EXPECT_EQ(m["axis"], "X");
  EXPECT_EQ(m["units"]["target"], "mm");
  EXPECT_EQ(m["units"]["deviation"], "um");
  EXPECT_EQ(m["missing"], 3);
  EXPECT_EQ(m["notes"][0], "a \"note\"\n");
  const auto& r = m["readings"];
  EXPECT_EQ(r["run"], nlohmann::json({1, 2}));
  EXPECT_EQ(r["direction"], nlohmann::json({"+", "-"}));
  EXPECT_EQ(r["target_mm"], nlohmann::json({25.2, 100.0}));
  EXPECT_EQ(r["deviation_um"], nlohmann::json({1.5, -2.0}));
  EXPECT_EQ(r["source_line"], nlohmann::json({2, 3}));
  EXPECT_EQ(r["time_s"], nlohmann::json({0.5, nullptr}));
  EXPECT_FALSE(r.contains("air_c"));
}

TEST(Json, RotaryAxis) {
  Observations o = two_readings();
  o.angular = true;
  o.axes[0].rotary = true;
  o.axes[0].position = {std::numbers::pi / 2, std::numbers::pi};
  o.deviation = {std::numbers::pi / 648000, 0.0};
  const auto json = parsed(written(campaign_of({measurement("C")}), {o}, {}));
  const auto& r = json["measurements"][0]["readings"];
  EXPECT_EQ(r["target_deg"], nlohmann::json({90.0, 180.0}));
  EXPECT_EQ(r["deviation_arcsec"], nlohmann::json({1.0, 0.0}));
}

TEST(Json, GeneralForm) {
  Observations o = two_readings();
  o.axes.push_back({"Y", false, {0.2, 0.3}, {}});
  o.lines.push_back({"second", {0, 0, 1}});
  o.line = {0, 1};
  const auto json = parsed(written(campaign_of({measurement("D")}), {o}, {}));
  const auto& r = json["measurements"][0]["readings"];
  EXPECT_EQ(r["X_mm"], nlohmann::json({25.2, 100.0}));
  EXPECT_EQ(r["X_dir"], nlohmann::json({"+", "-"}));
  EXPECT_EQ(r["Y_mm"], nlohmann::json({200.0, 300.0}));
  EXPECT_FALSE(r.contains("Y_dir"));
  EXPECT_EQ(r["nx"], nlohmann::json({1.0, 0.0}));
  EXPECT_EQ(r["nz"], nlohmann::json({0.0, 1.0}));
  EXPECT_EQ(r["line"], nlohmann::json({"X", "second"}));
}

TEST(Json, MeasurementThatCouldNotBeRead) {
  const auto json =
      parsed(written(campaign_of({measurement("X"), measurement("Y")}), {{}, two_readings()}, {}));
  EXPECT_TRUE(json["measurements"][0]["readings"].empty());
  EXPECT_EQ(json["measurements"][1]["readings"]["run"].size(), 2U);
  EXPECT_EQ(parsed(written(campaign_of({}), {}, {}))["measurements"], nlohmann::json::array());
}

TEST(Json, TextThatIsNotUtf8DoesNotStopIt) {
  const auto json = parsed(written(campaign_of({measurement("X\xF2")}), {two_readings()}, {}));
  EXPECT_EQ(json["measurements"][0]["id"], "X\xEF\xBF\xBD");
}

TEST(Json, ObservationsMustMatchTheMeasurements) {
  EXPECT_FALSE(written(campaign_of({measurement("X")}), {}, {}));
}

}  // namespace
}  // namespace nonio
