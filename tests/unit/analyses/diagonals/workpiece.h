// SPDX-License-Identifier: Apache-2.0
// A campaign of the exact machine, and the plugin as it was built.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bench.h"
#include "loaded_analysis.h"
#include "nonio/sdk/plugin.h"

namespace nonio::diagonal_test {

using namespace bench;

inline constexpr unsigned seed = 20261121;

inline const Analysis& the_analysis() {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "diagonal-straightness");
  return analysis;
}

inline Measurement named(const std::string& id, const std::string& kind, const std::string& axis) {
  Measurement m;
  m.id = id;
  m.kind = kind;
  m.axis = axis;
  return m;
}

/// Files of a campaign, read on the exact machine in two runs and both directions.
struct Workpiece {
  Rectangle rect;
  Errors errors;
  Campaign campaign;
  std::vector<Observations> all;
  double scatter = 0.0;
  machine::Curve BX = machine::zero, BY = machine::zero;  ///< reversal of positioning
  std::vector<int> directions{1, -1};                     ///< of approach, along the line
  std::mt19937 rng{seed};
  std::map<std::string, Setting> options;

  explicit Workpiece(const Rectangle& r, const Errors& e = {}) : rect(r), errors(e) {
    campaign.machine.structure = "gantry";
    for (const char* name : {"X", "Y"}) campaign.machine.axes.push_back(Axis{.name = name});
  }

  Observations& observe(Measurement m, const std::vector<Observations::AxisColumn>& places,
                        const std::vector<double>& mean, std::array<double, 3> sense) {
    std::normal_distribution<double> normal(0.0, 1.0);
    Observations o;
    o.measurement = m.id;
    o.lines.push_back({m.id, sense});
    o.axes = places;
    for (auto& a : o.axes) a.position.clear(), a.approach.clear();
    for (std::uint32_t run = 1; run <= 2; ++run)
      for (const int direction : directions)
        for (std::size_t j = 0; j < mean.size(); ++j) {
          double reversal = 0.0;
          for (std::size_t k = 0; k < places.size(); ++k) {
            const double p = places[k].position[j];
            o.axes[k].position.push_back(p);
            const bool rising = places[k].position.back() > places[k].position.front();
            o.axes[k].approach.push_back(static_cast<std::int8_t>(rising ? direction : -direction));
            const bool x = places[k].axis == "X";
            reversal += sense[x ? 0 : 1] * (x ? BX : BY)(p)*o.axes[k].approach.back() / 2.0;
          }
          o.deviation.push_back(mean[j] + reversal + scatter * normal(rng));
          o.run.push_back(run);
        }
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
    return all.back();
  }

  void diagonal(const std::string& id, const GridLine& line) {
    Measurement m = named(id, "diagonal", {});
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}, {"Y", false, {}, {}}};
    for (const std::size_t i : line.ix) places[0].position.push_back(rect.x(i));
    for (const std::size_t i : line.iy) places[1].position.push_back(rect.y(i));
    m.from = {{"X", places[0].position.front()}, {"Y", places[1].position.front()}};
    m.to = {{"X", places[0].position.back()}, {"Y", places[1].position.back()}};
    observe(std::move(m), places, line.mean, {line.cx, line.cy, 0.0});
  }
  void D1(const std::string& id = "D1") {
    diagonal(id, line(errors, rect, count(rect.n), count(rect.n)));
  }
  void D2(const std::string& id = "D2") {
    diagonal(id, line(errors, rect, count(rect.n), down(rect.n)));
  }
  void X(const std::string& id, double y) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    for (const std::size_t i : count(rect.n)) places[0].position.push_back(rect.x(i));
    Measurement m = named(id, "axis", "X");
    m.at["Y"] = y;
    observe(std::move(m), places, pitch_x(errors, rect, y).mean, {1.0, 0.0, 0.0});
  }
  void Y(const std::string& id = "Y") {
    std::vector<Observations::AxisColumn> places{{"Y", false, {}, {}}};
    for (const std::size_t i : count(rect.n)) places[0].position.push_back(rect.y(i));
    observe(named(id, "axis", "Y"), places, pitch_y(errors, rect).mean, {0.0, 1.0, 0.0});
  }
  /// As an autocollimator reads it, to `noise` of its own.
  void yaw(double noise = 0.0, double factor = 1.0) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    std::vector<double> mean;
    for (const std::size_t i : count(rect.n)) {
      places[0].position.push_back(rect.x(i));
      mean.push_back(3e-6 + factor * errors.ECX(rect.x(i)));  // its zero is free
    }
    Measurement m = named("yaw", "angle", "X");
    m.lateral = "Z";
    const double lengths = std::exchange(scatter, noise);
    observe(std::move(m), places, mean, {}).angular = true;
    scatter = lengths;
  }
  /// EYX against a straightedge whose own error is this.
  void straight(const std::string& id, const machine::Curve& edge) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}};
    std::vector<double> mean;
    for (const std::size_t i : count(rect.n)) {
      const double x = rect.x(i);
      places[0].position.push_back(x);
      mean.push_back(4 * um - 3e-6 * x + errors.EYX(x) + edge(x));
    }
    Measurement m = named(id, "straightness", "X");
    m.lateral = "Y";
    observe(std::move(m), places, mean, {0.0, 1.0, 0.0});
  }
  void turned_over(const machine::Curve& edge) {
    straight("SX", edge);
    straight("SX turned", [edge](double x) { return -edge(x); });
    campaign.measurements.back().reversal_of = "SX";
  }
  /// Both axes on a square whose error is g, as set up first and turned over about X.
  void square(double g) {
    campaign.squares.push_back({.name = "Q", .error = {}, .U = {}});
    for (const double sign : {1.0, -1.0})
      for (const bool x : {true, false}) {
        std::vector<Observations::AxisColumn> places{{x ? "X" : "Y", false, {}, {}}};
        std::vector<double> mean;
        for (const std::size_t i : count(rect.n)) {
          const double p = x ? rect.x(i) : rect.y(i);
          places[0].position.push_back(p);
          const machine::Vector at = machine::point(errors, {x ? p : 0.0, x ? 0.0 : p, 0.0});
          mean.push_back(x ? at.y() : at.x() + sign * g * p);
        }
        Measurement m = named(std::string(x ? "QX" : "QY") + (sign < 0.0 ? " t" : ""),
                              "straightness", x ? "X" : "Y");
        m.state = "";
        m.lateral = x ? "Y" : "X";
        m.square = "Q";
        m.square_turned = sign < 0.0;
        observe(std::move(m), places, mean, {});
      }
  }
  /// States everything that the manifest has of the uncertainty, small.
  void states_all() {
    campaign.instrument.U_fixed = 1e-9, campaign.instrument.U_per_length = 1e-10;
    Environment& e = campaign.environment;
    e.misalignment = e.temperature_range = 1e-3, e.temperature_difference = 0.01;
    e.expansion_range = 1e-9, e.drift = 1e-10;
    for (Axis& axis : campaign.machine.axes) axis.expansion = 1e-6;
  }
  Workpiece& everything() {
    X("X1", 0.5);
    X("X2", 8.5);
    Y();
    D1();
    D2();
    return *this;
  }

  std::size_t index(const std::string& id) const {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (campaign.measurements[i].id == id) return i;
    throw std::out_of_range(id);
  }
  Evaluation evaluate(const std::string& id = "D1") const {
    Settings settings;
    for (const Option& o : the_analysis().info.options) settings.values[o.name] = o.default_value;
    for (const auto& [name, value] : options) {
      EXPECT_EQ(settings.values.count(name), 1U) << name;
      settings.values[name] = value;
    }
    const std::size_t i = index(id);
    EXPECT_TRUE(the_analysis().applies(campaign, campaign.measurements[i]));
    const auto e =
        the_analysis().analyse({campaign, campaign.measurements[i], all[i], settings, &all});
    EXPECT_TRUE(e) << (e ? "" : e.error().message);
    return e.value_or(Evaluation{});
  }
};

inline const Finding* finding(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == "diagonals." + id) return &f;
  return nullptr;
}
inline std::string ids(const Evaluation& e) {
  std::string out;
  for (const Finding& f : e.findings) out += f.id + " ";
  return out;
}
inline double value(const Evaluation& e, const std::string& name) {
  for (const Value& v : e.values)
    if (v.name == name) return v.value;
  ADD_FAILURE() << "no value " << name;
  return 0.0;
}
inline const Series* series(const Evaluation& e, const std::string& name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

/// Refused: no value but the checks, no curve, and the reason by its name.
inline void expect_refused(const Workpiece& w, const std::string& why,
                           const std::string& id = "D1") {
  const Evaluation e = w.evaluate(id);
  ASSERT_NE(finding(e, why), nullptr) << why << ", found " << ids(e);
  EXPECT_TRUE(finding(e, why)->attention);
  EXPECT_TRUE(e.series.empty());
  for (const Value& v : e.values) EXPECT_TRUE(v.name == "S_n" || v.name == "S_odd") << v.name;
}

}  // namespace nonio::diagonal_test
