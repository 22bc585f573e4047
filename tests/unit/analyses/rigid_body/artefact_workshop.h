// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "loaded_analysis.h"
#include "nonio/math/rigid_artefact.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"
#include "rigid_workshop.h"

extern "C" const nonio::PluginEntry nonio_plugin;

/// Artefacts and squares on the exact machine, and the campaign that the plugin gets of them.
namespace rigid_workshop {

using machine::Vector;
using nonio::Observations;

/// Positions of the axes when the tool is at a place: the inverse of the exact machine.
inline Vector commanded(const machine::Errors& errors, const Vector& place) {
  Vector at = place;
  for (int i = 0; i < 8; ++i) at -= machine::point(errors, at) - place;
  return at;
}

struct Pose {
  std::string id;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector shift = Vector::Zero();
};

/// From x, y of the artefact to two coordinates of the machine, a little askew.
inline Pose pose_in(const std::string& id, int first, int second, const Vector& corner,
                    double askew) {
  Pose p;
  p.id = id;
  p.turn.col(0) = Vector::Unit(first);
  p.turn.col(1) = Vector::Unit(second);
  p.turn.col(2) = p.turn.col(0).cross(p.turn.col(1));
  p.turn = Eigen::AngleAxisd(askew, Vector(0.3, -0.5, 0.8).normalized()).matrix() * p.turn;
  p.shift = corner;
  return p;
}

/// A plate of n x n balls, the pitch as nominal.
inline std::vector<Vector> plate(int n, double size) {
  std::vector<Vector> out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) out.emplace_back(size * i / (n - 1), size * j / (n - 1), 0.0);
  return out;
}

/// Poses of a plate of 0.5 m that reach every edge of the volume.
inline std::vector<Pose> poses_of_plate() {
  const double a = 0.002;
  return {
      pose_in("P1", 0, 1, {0.01, 0.02, 0.01}, a),    pose_in("P2", 0, 1, {0.29, 0.07, 0.01}, -a),
      pose_in("P3", 0, 1, {0.01, 0.05, 0.58}, a),    pose_in("P4", 0, 1, {0.29, 0.02, 0.58}, a),
      pose_in("P5", 0, 2, {0.01, 0.01, 0.03}, -a),   pose_in("P6", 0, 2, {0.28, 0.58, 0.06}, a),
      pose_in("P7", 1, 2, {0.01, 0.04, 0.05}, a),    pose_in("P8", 1, 2, {0.78, 0.05, 0.02}, -a),
      pose_in("P9", 1, 2, {0.40, 0.02, 0.05}, 2 * a)};
}

inline std::string ball_name(std::size_t b) { return "b" + std::to_string(b + 1); }

/// Centres as the reader gives them: three readings of each ball, in `runs`.
inline Observations probed_on(const Truth& t, const std::vector<Vector>& balls, const Pose& pose,
                              const Noise& noise, int runs = 1, double stretched = 0.0) {
  Observations o;
  o.measurement = pose.id;
  o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (std::size_t b = 0; b < balls.size(); ++b)
    for (int k = 0; k < 3; ++k)
      o.lines.push_back({ball_name(b) + " " + "xyz" [k],
                         { k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0. }});
  for (int run = 1; run <= runs; ++run)
    for (std::size_t b = 0; b < balls.size(); ++b) {
      Vector at = commanded(t.errors, pose.turn * balls[b] + pose.shift) * (1.0 + stretched);
      for (int k = 0; k < 3; ++k) at[k] += noise();
      for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 3; ++c) o.axes[static_cast<std::size_t>(c)].position.push_back(at[c]);
        o.deviation.push_back(at[k]);
        o.line.push_back(static_cast<std::uint32_t>(3 * b) + static_cast<std::uint32_t>(k));
        o.run.push_back(static_cast<std::uint32_t>(run));
        o.source_line.push_back(static_cast<std::uint32_t>(o.source_line.size() / 3 + 2));
      }
    }
  return o;
}

inline Observations certificate_of(const std::vector<Vector>& balls, double u) {
  Observations o;
  o.measurement = "certificate";
  o.axes = {{"certificate", false, {}, {}}};
  for (std::size_t b = 0; b < balls.size(); ++b)
    for (int k = 0; k < 3; ++k) {
      o.lines.push_back({ball_name(b) + " " + "xyz" [k],
                         { k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0. }});
      o.line.push_back(static_cast<std::uint32_t>(3 * b) + static_cast<std::uint32_t>(k));
      o.axes[0].position.push_back(static_cast<double>(b + 1));
      o.deviation.push_back(balls[b][k]);
      o.u.push_back(u);
      o.run.push_back(1);
      o.source_line.push_back(static_cast<std::uint32_t>(b + 2));
    }
  return o;
}

/// A line of straightness on a face of a square, positive towards the other axis: `leans` the face
/// away from its axis.
inline Observations on_face(const Truth& t, std::size_t axis, std::size_t across,
                            const std::pair<Vector, Vector>& box, double leans, int runs,
                            const Noise& noise) {
  constexpr std::size_t n = 12;
  const auto moves = static_cast<Eigen::Index>(axis);
  Observations o;
  o.axes = {{std::string(1, "XYZ"[axis]), false, {}, {}}};
  Observations::Line line{"face", {}};
  line.sense[across] = 1.0;
  o.lines = {line};
  for (int run = 1; run <= runs; ++run)
    for (const int way : {1, -1})
      for (std::size_t i = 0; i <= n; ++i) {
        const std::size_t step = way > 0 ? i : n - i;
        Vector at(0.4, 0.3, 0.3);
        const double far = box.first[moves] + (box.second[moves] - box.first[moves]) *
                                                  static_cast<double>(step) /
                                                  static_cast<double>(n);
        at[moves] = far;
        const Vector e = machine::point(t.errors, at) - at;
        o.axes[0].position.push_back(far);
        o.axes[0].approach.push_back(static_cast<std::int8_t>(way));
        o.deviation.push_back(e[static_cast<Eigen::Index>(across)] + leans * far + noise());
        o.run.push_back(static_cast<std::uint32_t>(run));
        o.line.push_back(0);
        o.source_line.push_back(static_cast<std::uint32_t>(o.source_line.size() + 2));
      }
  return o;
}

inline nonio::Analysis the_analysis() { return nonio::analysis_of(nonio_plugin); }

/// A campaign as the host gives it to the plugin.
struct Workshop {
  nonio::Campaign campaign;
  std::vector<Observations> all;
  nonio::Settings options;

  Workshop() {
    for (const nonio::Option& o : the_analysis().info.options)
      options.values[o.name] = o.default_value;
    for (const char* name : {"X", "Y", "Z"}) {
      campaign.machine.axes.push_back(nonio::Axis{.name = name});
      campaign.machine.axes.back().expansion = 11.5e-6;
    }
    campaign.environment.temperature_range = 0.001;
    campaign.environment.temperature_difference = 0.5;
    campaign.environment.expansion_range = 1e-9;
    campaign.environment.drift = 1e-9;
    campaign.environment.misalignment = 0.0;
    campaign.instrument.U_fixed = 1e-9;
    campaign.instrument.U_per_length = 1e-9;
    campaign.instrument.U_angle = 1e-9;
    with("artefact_expansion", 11.5).with("artefact_temperature_range_K", 0.001);
    with("artefact_expansion_range", 0.001).with("degree", std::int64_t{2});
    with("parts", std::int64_t{2});
  }
  Workshop& with(const std::string& name, nonio::Setting value) {
    options.values[name] = std::move(value);
    return *this;
  }
  nonio::Measurement& add(const std::string& id, const std::string& kind, Observations o) {
    nonio::Measurement m;
    m.id = id;
    m.kind = kind;
    if (kind.starts_with("artefact")) m.lateral = "plate";
    campaign.measurements.push_back(m);
    all.push_back(std::move(o));
    return campaign.measurements.back();
  }
  nonio::Expected<nonio::Evaluation> done() const {
    const nonio::Analysis analysis = the_analysis();
    for (std::size_t i = 0; i < all.size(); ++i)
      if (analysis.applies(campaign, campaign.measurements[i]))
        return analysis.analyse({campaign, campaign.measurements[i], all[i], options, &all});
    return nonio::fail("applies to nothing");
  }
};

inline const nonio::Value* value(const nonio::Evaluation& e, std::string_view name) {
  for (const nonio::Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

inline const nonio::Finding* found(const nonio::Evaluation& e, std::string_view id) {
  for (const nonio::Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

}  // namespace rigid_workshop
