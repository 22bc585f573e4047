// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "nonio/math/rotary.h"
#include "nonio/sdk/observations.h"

/// An exact rotary table: every centre is the first one, turned about the line by a quaternion.
/// Nothing of the kernel's formulas.
namespace nonio::turntable {

inline constexpr double um = 1e-6, mm = 1e-3, urad = 1e-6, deg = std::numbers::pi / 180.0;

struct Table {
  Eigen::Vector3d centre{0.102532, 0.051230, 0.128947};
  Eigen::Vector3d direction{0, 0, 1};
  double radius = 0.261;
  double phase = 0.3;                                         ///< of the ball at angle 0
  Eigen::Matrix3d linear_axes = Eigen::Matrix3d::Identity();  ///< what reads the centres

  math::BallCentre at(double angle) const {
    const Eigen::Vector3d n = direction.normalized();
    const Eigen::Vector3d arm = radius * n.unitOrthogonal();
    const Eigen::Vector3d p = linear_axes * (centre + Eigen::AngleAxisd(phase + angle, n) * arm);
    return {{p[0], p[1], p[2]}, angle, 1.0};
  }
  std::vector<math::BallCentre> at(const std::vector<double>& angles) const {
    std::vector<math::BallCentre> out;
    for (const double a : angles) out.push_back(at(a));
    return out;
  }
};

inline std::vector<double> full_turn(int n) {
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(i * 360.0 * deg / n);
  return out;
}

inline std::vector<double> arc(double from, double to, int n) {
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(from + (to - from) * i / (n - 1));
  return out;
}

/// Normal noise from a seed.
class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  std::vector<math::BallCentre> on(std::vector<math::BallCentre> centres, double sigma) {
    for (auto& c : centres)
      for (double& x : c.at) x += sigma * normal_(engine_) / std::sqrt(c.weight);
    return centres;
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// As the reader of files makes it: three readings a centre.
inline Observations observed(const std::vector<math::BallCentre>& centres,
                             const std::string& axis = "C") {
  Observations o;
  o.measurement = axis;
  o.axes = {{axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (const char* name : {" x", " y", " z"}) o.lines.push_back({axis + name, {}});
  std::uint32_t line = 1;
  for (const auto& c : centres) {
    ++line;
    for (std::size_t k = 0; k < 3; ++k) {
      o.axes[0].position.push_back(c.angle);
      for (std::size_t i = 0; i < 3; ++i) o.axes[1 + i].position.push_back(c.at[i]);
      o.deviation.push_back(c.at[k]);
      o.line.push_back(static_cast<std::uint32_t>(k));
      o.run.push_back(1);
      o.source_line.push_back(line);
    }
  }
  return o;
}

inline double distance(const math::Vector3& a, const Eigen::Vector3d& b) {
  return (Eigen::Vector3d(a[0], a[1], a[2]) - b).norm();
}

}  // namespace nonio::turntable
