// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "machine.h"
#include "nonio/math/rigid_body.h"

/// A machine with smooth errors, exact, and the readings that instruments would take on it.
namespace rigid_workshop {

using nonio::math::Corner;
using nonio::math::RigidLine;
using nonio::math::RigidReading;

inline const Corner low{0.0, 0.0, 0.0}, high{0.8, 0.6, 0.6};

/// Polynomials of up to fourth degree; m or rad. The constant of an angle is 0: it is squareness.
struct Truth {
  machine::Errors errors;
  std::map<std::string, std::vector<double>> of;  ///< sizes of P_1..P_4
};

inline double legendre4(std::size_t k, double t) {
  switch (k) {
    case 1:
      return t;
    case 2:
      return (3 * t * t - 1) / 2;
    case 3:
      return (5 * t * t * t - 3 * t) / 2;
    default:
      return (35 * t * t * t * t - 30 * t * t + 3) / 8;
  }
}

inline std::size_t axis_of(const std::string& error) {
  return static_cast<std::size_t>(error[2] - 'X');
}

inline Truth any_machine(std::mt19937_64& random, double um, double urad) {
  Truth t;
  std::normal_distribution<double> normal;
  for (const std::string& name : nonio::math::rigid_errors()) {
    if (name[1] == '0') continue;
    const bool angle = name[1] <= 'C', along = name[1] == name[2];
    std::vector<double> c(4, 0.0);
    for (std::size_t k = angle || along ? 0 : 1; k < 4; ++k)
      c[k] = normal(random) * (angle ? urad * 1e-6 : um * 1e-6) / static_cast<double>(k + 1);
    const std::size_t axis = axis_of(name);
    const double length = high[axis] - low[axis];
    t.errors[name] = [c, length](double at) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 4; ++k) sum += c[k] * legendre4(k + 1, 2.0 * at / length - 1.0);
      return sum;
    };
    t.of[name] = c;
  }
  t.errors.C0Y = normal(random) * 20e-6;
  t.errors.B0Z = normal(random) * 20e-6;
  t.errors.A0Z = normal(random) * 20e-6;
  t.errors.y_ref = (low[1] + high[1]) / 2.0;
  t.errors.z_ref = (low[2] + high[2]) / 2.0;
  return t;
}

struct Noise {
  std::mt19937_64* random = nullptr;
  double u = 0.0;
  double operator()() const {
    return random == nullptr ? 0.0 : std::normal_distribution<double>(0.0, u)(*random);
  }
};

inline std::vector<machine::Vector> stops_between(const Corner& from, const Corner& to,
                                                  std::size_t n) {
  std::vector<machine::Vector> out;
  for (std::size_t i = 0; i <= n; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(n);
    out.emplace_back(from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]),
                     from[2] + part * (to[2] - from[2]));
  }
  return out;
}

inline Corner corner_of(const machine::Vector& v) { return {v[0], v[1], v[2]}; }

/// A retroreflector on a straight line, `runs` times there and back.
inline RigidLine beam(const Truth& t, const Corner& from, const Corner& to, std::size_t n,
                      std::size_t runs, const Noise& noise, double lost_motion = 0.0) {
  const auto stops = stops_between(from, to, n);
  const auto exact = machine::interferometer(t.errors, stops);
  const machine::Vector way = (stops.back() - stops.front()).normalized();
  RigidLine line;
  for (std::size_t run = 0; run < runs; ++run)
    for (const int direction : {1, -1})
      for (std::size_t i = 0; i < stops.size(); ++i)
        line.readings.push_back({corner_of(stops[i]), corner_of(way), direction,
                                 exact[i] + noise() - direction * lost_motion / 2.0});
  return line;
}

/// A straightedge along one axis, not quite parallel to it.
inline RigidLine straightedge(const Truth& t, const Corner& from, const Corner& to,
                              std::size_t across, std::size_t n, double slope, const Noise& noise) {
  RigidLine line;
  line.kind = RigidLine::Kind::across;
  line.group = 1;
  const auto stops = stops_between(from, to, n);
  for (const auto& stop : stops) {
    Corner sense{};
    sense[across] = 1.0;
    const machine::Vector e = machine::point(t.errors, stop) - stop;
    line.readings.push_back(
        {corner_of(stop), sense, 1,
         e[static_cast<Eigen::Index>(across)] + slope * (stop - stops.front()).norm() + noise()});
  }
  return line;
}

/// Angle of an axis by an autocollimator.
inline RigidLine autocollimator(const Truth& t, std::size_t axis, std::size_t about, std::size_t n,
                                const Noise& noise) {
  RigidLine line;
  line.kind = RigidLine::Kind::angle;
  line.of = axis, line.about = about;
  line.group = 2;
  std::string name = "EAX";
  name[1] = static_cast<char>('A' + about), name[2] = static_cast<char>('X' + axis);
  machine::Errors errors = t.errors;
  for (std::size_t i = 0; i <= n; ++i) {
    Corner at = low;
    at[axis] += (high[axis] - low[axis]) * static_cast<double>(i) / static_cast<double>(n);
    line.readings.push_back({at, {}, 1, errors[name](at[axis]) + noise()});
  }
  return line;
}

/// One of the four step diagonals, its mirror tilted.
inline RigidLine step_diagonal(const Truth& t, const std::array<int, 3>& sign, std::size_t n,
                               const Eigen::Vector2d& tilt, const Noise& noise) {
  machine::Vector at, step;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    at[i] = sign[k] > 0 ? low[k] : high[k];
    step[i] = sign[k] * (high[k] - low[k]) / static_cast<double>(n);
  }
  std::vector<machine::Vector> stops{at};
  for (std::size_t i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k) at[k] += step[k], stops.push_back(at);
  const machine::Vector beam = step.normalized();
  const auto exact = machine::flat_mirror(t.errors, stops, beam, tilt);
  RigidLine line;
  line.kind = RigidLine::Kind::mirror;
  line.group = 3;
  for (std::size_t i = 0; i < stops.size(); ++i)
    line.readings.push_back(
        {corner_of(stops[i]), corner_of(beam), 1, exact[i] + (i == 0 ? 0.0 : noise())});
  return line;
}

inline Corner place(double x, double y, double z) {
  return {low[0] + x * (high[0] - low[0]), low[1] + y * (high[1] - low[1]),
          low[2] + z * (high[2] - low[2])};
}

/// Axis runs on several lines, straightedges, diagonals and autocollimators: everything that the
/// error vector in the volume needs.
inline std::vector<RigidLine> whole_campaign(const Truth& t, std::mt19937_64* random, double u) {
  const Noise noise{random, u}, across{random, 1.5 * u}, angle{random, u / 0.3};
  std::vector<RigidLine> lines;
  for (const auto& [y, z] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}})
    lines.push_back(beam(t, place(0, y, z), place(1, y, z), 16, 2, noise, 3e-6));
  for (const double z : {0.0, 1.0})
    lines.push_back(beam(t, place(0.5, 0, z), place(0.5, 1, z), 16, 2, noise, 2e-6));
  lines.push_back(beam(t, place(0.5, 0.5, 0), place(0.5, 0.5, 1), 16, 2, noise, 1e-6));
  for (const double y : {0.0, 1.0}) {
    lines.push_back(straightedge(t, place(0, y, 0.5), place(1, y, 0.5), 2, 16, 30e-6, across));
    lines.push_back(straightedge(t, place(0, y, 0.5), place(1, y, 0.5), 1, 16, -20e-6, across));
  }
  for (const double z : {0.0, 1.0}) {
    lines.push_back(straightedge(t, place(0.5, 0, z), place(0.5, 1, z), 0, 16, 10e-6, across));
    lines.push_back(straightedge(t, place(0.5, 0, z), place(0.5, 1, z), 2, 16, 15e-6, across));
  }
  lines.push_back(straightedge(t, place(0.5, 0.5, 0), place(0.5, 0.5, 1), 0, 16, 12e-6, across));
  lines.push_back(straightedge(t, place(0.5, 0.5, 0), place(0.5, 0.5, 1), 1, 16, 11e-6, across));
  for (const auto& [axis, about] : {std::pair{0U, 0U}, {0U, 1U}, {0U, 2U}, {1U, 0U}, {1U, 1U}})
    lines.push_back(autocollimator(t, axis, about, 16, angle));
  for (const auto& [from, to] : {std::pair{place(0, 0, 0), place(1, 1, 1)},
                                 {place(1, 0, 0), place(0, 1, 1)},
                                 {place(0, 1, 0), place(1, 0, 1)},
                                 {place(0, 0, 1), place(1, 1, 0)}})
    lines.push_back(beam(t, from, to, 16, 2, noise, 3e-6));
  return lines;
}

/// Error of the tool point of the exact machine, less that in the middle of the volume.
inline Corner exact_error(const Truth& t, const Corner& at) {
  const machine::Vector p(at[0], at[1], at[2]),
      zero((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, (low[2] + high[2]) / 2.0);
  const machine::Vector e =
      machine::point(t.errors, p) - p - (machine::point(t.errors, zero) - zero);
  return {e[0], e[1], e[2]};
}

}  // namespace rigid_workshop
