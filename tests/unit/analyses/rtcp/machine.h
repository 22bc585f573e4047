// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "loaded_analysis.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

extern "C" const nonio::PluginEntry nonio_plugin;

/// A machine whose rotary axis and linear axes move exactly, and a control with a wrong axis line:
/// computed by quaternions, without the kernel's formulas.
namespace nonio::rtcp_test {

using Vector = Eigen::Vector3d;
inline constexpr double um = 1e-6, urad = 1e-6, deg = std::numbers::pi / 180.0;

struct Machine {
  Vector centre{0.3, 0.2, 0.1}, direction{0.0, 0.0, 1.0};  // of the control
  Vector true_centre = centre, true_direction = direction;
  bool head = false;
  Eigen::Matrix3d linear = Eigen::Matrix3d::Zero();  // errors of the linear axes, zero at `about`
  Vector about = centre;

  Vector turned(const Vector& v, const Vector& n, double angle) const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, n.normalized())) * v;
  }
  Vector as_meant(const Vector& ball, double angle) const {
    return centre + turned(ball - centre, direction, angle);
  }
  /// Commanded place of the linear axes.
  Vector axes(const Vector& ball, double angle) const {
    return head ? Vector(ball - (as_meant(ball, angle) - centre)) : as_meant(ball, angle);
  }
  /// The tool against the workpiece, less what was commanded.
  Vector moved(const Vector& ball, const Vector& offset, double angle) const {
    const Vector is = true_centre + turned(ball + offset - true_centre, true_direction, angle);
    const Vector by_axis = is - as_meant(ball, angle);
    const Vector by_linear = linear * (axes(ball, angle) - (head ? ball : about));
    return (head ? by_axis : Vector(-by_axis)) + by_linear;
  }
};

/// A line of readings: one gauge on one ball.
struct Line {
  Vector ball, sense;
  bool turns = true;
  Vector offset = Vector::Zero();
  double zero = 0.0;
};

inline std::vector<double> angles(int n, double to = 2.0 * std::numbers::pi) {
  std::vector<double> out;
  const bool full = to > 6.28;
  for (int i = 0; i < n; ++i) out.push_back(to * i / (full ? n : n - 1));
  return out;
}

inline Observations begin() {
  Observations o;
  o.measurement = "C";
  o.axes = {{"C", true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  return o;
}

inline void put(Observations& o, std::size_t line, double angle, const Vector& at, const Vector& s,
                double deviation) {
  o.axes[0].position.push_back(angle);
  for (int k = 0; k < 3; ++k) o.axes[1 + static_cast<std::size_t>(k)].position.push_back(at[k]);
  o.sense.push_back({s[0], s[1], s[2]});
  o.line.push_back(static_cast<std::uint32_t>(line));
  o.run.push_back(1);
  o.source_line.push_back(static_cast<std::uint32_t>(o.source_line.size() + 2));
  o.deviation.push_back(deviation);
}

/// noise(): added to each reading.
template <class Noise>
Observations gauges(const Machine& m, const std::vector<Line>& lines, const std::vector<double>& at,
                    Noise noise) {
  Observations o = begin();
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const Line& line = lines[l];
    o.lines.push_back(
        {"gauge " + std::to_string(l + 1), {line.sense[0], line.sense[1], line.sense[2]}});
    for (const double angle : at) {
      const Vector s = line.turns ? m.turned(line.sense, m.direction, angle) : line.sense;
      put(o, l, angle, m.axes(line.ball, angle), s,
          s.dot(m.moved(line.ball, line.offset, angle)) + line.zero + noise());
    }
  }
  return o;
}

template <class Noise>
Observations probe(const Machine& m, const std::vector<Line>& balls, const std::vector<double>& at,
                   const Vector& zero, Noise noise) {
  Observations o = begin();
  for (std::size_t b = 0; b < balls.size(); ++b) {
    for (int k = 0; k < 3; ++k) {
      Observations::Line line{"ball " + std::to_string(b + 1) + " found " + "xyz" [k], {}};
      line.sense[static_cast<std::size_t>(k)] = 1.0;
      o.lines.push_back(line);
    }
    for (const double angle : at)
      for (int k = 0; k < 3; ++k)
        put(o, 3 * b + static_cast<std::size_t>(k), angle, m.axes(balls[b].ball, angle),
            Vector::Unit(k), m.moved(balls[b].ball, balls[b].offset, angle)[k] + zero[k] + noise());
  }
  return o;
}

inline Analysis the_analysis() { return analysis_of(nonio_plugin); }

/// A campaign as the host gives it to the plugin.
struct Workshop {
  Campaign campaign;
  std::vector<Observations> all;
  Settings options;

  explicit Workshop(bool head = false) {
    for (const Option& o : the_analysis().info.options) options.values[o.name] = o.default_value;
    options.values[head ? "heads" : "tables"] = std::vector<std::string>{"C"};
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
  Workshop& measured(const Observations& o, const std::string& adjustment = {}) {
    Measurement m;
    m.id = "C" + adjustment;
    m.axis = "C";
    m.kind = "rtcp";
    m.adjustment = adjustment;
    campaign.measurements.push_back(m);
    all.push_back(o);
    return *this;
  }
  Expected<Evaluation> last() const {
    return the_analysis().analyse(
        {campaign, campaign.measurements.back(), all.back(), options, &all});
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

}  // namespace nonio::rtcp_test
