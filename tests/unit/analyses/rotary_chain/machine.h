// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "loaded_analysis.h"
#include "nonio/math/rotary_chain.h"
#include "nonio/sdk/plugin.h"
#include "table.h"

extern "C" const nonio::PluginEntry nonio_plugin;

/// A five-axis machine by homogeneous transforms: each joint is a frame that turns about its own Z.
/// Nothing of the kernel's formulas.
namespace nonio::chain_test {

using Vector = Eigen::Vector3d;
using turntable::deg;
using turntable::um;
using turntable::urad;

struct Joint {
  std::string name;
  Vector point, direction;

  Eigen::Isometry3d at(double angle) const {
    const Eigen::Isometry3d frame =
        Eigen::Translation3d(point) *
        Eigen::Quaterniond::FromTwoVectors(Vector::UnitZ(), direction.normalized());
    return frame * Eigen::AngleAxisd(angle, Vector::UnitZ()) * frame.inverse();
  }
};

struct Machine {
  std::vector<Joint> tables, heads;  ///< from the bed outwards, with all joints at 0
  Vector ball{0.45, 0.30, -0.10}, tip{0.02, -0.01, -0.35}, tool = Vector::Zero();
  Eigen::Matrix3d linear = Eigen::Matrix3d::Zero();  ///< errors of the linear axes about `middle`
  Vector middle = Vector::Zero();

  std::size_t axes() const { return tables.size() + heads.size(); }
  /// What the linear axes show: with the heads at 0 it is the place of the tip of the first tool.
  Vector reading(const std::vector<double>& angle) const {
    Eigen::Isometry3d work = Eigen::Isometry3d::Identity(), spindle = work;
    for (std::size_t j = 0; j < tables.size(); ++j) work = work * tables[j].at(angle[j]);
    for (std::size_t j = 0; j < heads.size(); ++j)
      spindle = spindle * heads[j].at(angle[tables.size() + j]);
    const Vector shown = work * ball - spindle * (tip + tool) + tip;
    return shown + linear * (shown - middle);
  }
  const Joint& joint(std::size_t j) const {
    return j < tables.size() ? tables[j] : heads[j - tables.size()];
  }
  /// Where the results have the axis: of a head as seen from the tip.
  Vector point(std::size_t j) const {
    return j < tables.size() ? joint(j).point : Vector(joint(j).point - tip);
  }
  Vector direction(std::size_t j) const { return joint(j).direction.normalized(); }
  Vector centre(std::size_t j) const {
    const Vector from = j < tables.size() ? ball : Vector::Zero();
    return point(j) + direction(j) * direction(j).dot(from - point(j));
  }
};

using Positions = std::vector<std::vector<double>>;

inline Positions grid(const std::vector<double>& first, const std::vector<double>& second) {
  Positions out;
  for (const double a : first)
    for (const double b : second) out.push_back({a * deg, b * deg});
  return out;
}

inline const std::vector<double> tilts{-60, -30, 0, 30, 60, 90}, turns{0, 60, 120, 180, 240, 300};

/// B carries C; axes that lean by up to 200 urad and miss each other by up to 100 um.
class Builder {
 public:
  explicit Builder(std::uint64_t seed) : random_(seed) {}
  double normal() { return normal_(random_); }
  double uniform(double half) {
    return std::uniform_real_distribution<double>(-half, half)(random_);
  }
  Joint joint(const std::string& name, const Vector& point, const Vector& direction) {
    return {name, point + Vector(uniform(100 * um), uniform(100 * um), uniform(100 * um)),
            direction.normalized() +
                Vector(uniform(200 * urad), uniform(200 * urad), uniform(200 * urad))};
  }
  Machine tables(const Vector& tilt = Vector::UnitY()) {
    Machine m;
    m.tables = {joint("B", {0.41, 0.10, -0.31}, tilt),
                joint("C", {0.41, 0.305, -0.2}, Vector::UnitZ())};
    return m;
  }
  Machine head_and_table() {
    Machine m;
    m.tables = {joint("C", {0.41, 0.305, -0.2}, Vector::UnitZ())};
    m.heads = {joint("B", {0.02, -0.05, 0.0}, Vector::UnitY())};
    return m;
  }
  Machine heads() {
    Machine m;
    m.heads = {joint("C", {0.02, -0.01, 0.3}, Vector::UnitZ()),
               joint("B", {0.02, -0.03, 0.0}, Vector::UnitY())};
    return m;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

inline math::ChainOrder order_of(const Machine& m) {
  return {m.tables.size(), m.heads.size(), 1, 1};
}

inline std::vector<math::ChainReading> readings(const Machine& m, const Positions& at) {
  std::vector<math::ChainReading> out;
  for (const auto& angle : at) {
    const Vector p = m.reading(angle);
    out.push_back({{p[0], p[1], p[2]}, angle});
  }
  return out;
}

/// As the reader of files makes it: three readings a centre; `axis` is the last one of the chain.
inline Observations observed(const std::vector<math::ChainReading>& all, const Machine& m,
                             const std::string& id = "BC") {
  Observations o;
  o.measurement = id;
  const std::size_t last = m.axes() - 1;
  o.axes = {{m.joint(last).name, true, {}, {}},
            {"X", false, {}, {}},
            {"Y", false, {}, {}},
            {"Z", false, {}, {}}};
  for (std::size_t j = 0; j < last; ++j) o.axes.push_back({m.joint(j).name, true, {}, {}});
  for (const char* name : {" x", " y", " z"}) o.lines.push_back({id + name, {}});
  std::uint32_t line = 1;
  for (const auto& r : all) {
    ++line;
    for (std::size_t k = 0; k < 3; ++k) {
      o.axes[0].position.push_back(r.angle[last]);
      for (std::size_t i = 0; i < 3; ++i) o.axes[1 + i].position.push_back(r.at[i]);
      for (std::size_t j = 0; j < last; ++j) o.axes[4 + j].position.push_back(r.angle[j]);
      o.deviation.push_back(r.at[k]);
      o.line.push_back(static_cast<std::uint32_t>(k));
      o.run.push_back(1);
      o.source_line.push_back(line);
    }
  }
  return o;
}

inline Analysis the_analysis() { return analysis_of(nonio_plugin); }

/// A campaign as the host gives it to the plugin.
struct Workshop {
  Campaign campaign;
  std::vector<Observations> all;
  Settings options;

  explicit Workshop(const Machine& m) {
    for (const Option& o : the_analysis().info.options) options.values[o.name] = o.default_value;
    for (const bool head : {false, true}) {
      std::vector<std::string> names;
      for (const Joint& j : head ? m.heads : m.tables) names.push_back(j.name);
      options.values[head ? "heads" : "tables"] = names;
    }
    for (const char* name : {"B", "C"}) {
      campaign.machine.axes.push_back(Axis{.name = name});
      campaign.machine.axes.back().rotary = true;
    }
    for (const char* name : {"X", "Y", "Z"}) {
      campaign.machine.axes.push_back(Axis{.name = name});
      campaign.machine.axes.back().expansion = 11.5e-6;
    }
  }
  Workshop& with(const std::string& name, Setting value) {
    options.values[name] = std::move(value);
    return *this;
  }
  /// Everything that a budget needs.
  Workshop& stated(double U_fixed, double drift, double linear_axes_urad) {
    campaign.instrument.U_fixed = U_fixed;
    campaign.instrument.U_per_length = 0.1 * um;
    campaign.instrument.sphere = campaign.instrument.probe = U_fixed;
    campaign.environment.temperature_range = 0.01;
    campaign.environment.temperature_difference = 0.01;
    campaign.environment.expansion_range = 1e-7;
    campaign.environment.drift = drift;
    return with("linear_axes_urad", linear_axes_urad);
  }
  Workshop& measured(const Observations& o, double tool_length = 0.0) {
    Measurement m;
    m.id = o.measurement;
    m.axis = o.axes.front().axis;
    m.kind = "ball-centres";
    if (tool_length > 0.0) m.tool_offset["Z"] = -tool_length;
    campaign.measurements.push_back(m);
    all.push_back(o);
    return *this;
  }
  Expected<Evaluation> evaluated() const {
    return the_analysis().analyse(
        {campaign, campaign.measurements.front(), all.front(), options, &all});
  }
};

inline const Value* value(const Evaluation& e, std::string_view name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

inline const Finding* found(const Evaluation& e, std::string_view id) {
  for (const Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

}  // namespace nonio::chain_test
