// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

namespace nonio {

/// What the columns of an effect in space are made of.
struct SpaceReadings {
  /// x, y, z of each reading from the corner of the measured volume, m; NaN where nobody said where
  /// the axis stood. A coordinate that no axis has is empty.
  std::array<std::vector<double>, 3> r;
  std::array<double, 3> length{};  ///< of the measured volume

  bool moves(std::size_t k) const { return length[k] > 0.0; }
  /// How far a point is from the corner: 0 where nobody said.
  double lever(std::size_t k, std::size_t i) const {
    return r[k].empty() || !std::isfinite(r[k][i]) ? 0.0 : r[k][i];
  }
};

inline SpaceReadings space_of(const Observations& o) {
  SpaceReadings out;
  for (const auto& axis : o.axes) {
    const std::size_t k = coordinate_of(axis.axis);
    if (axis.rotary || k > 2) continue;
    auto& r = out.r[k];
    r.resize(o.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < o.size(); ++i)
      if (std::isfinite(axis.position[i])) r[i] = axis.position[i];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double x : out.r[k])
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    if (!(low <= high)) continue;
    out.length[k] = high - low;
    for (double& x : out.r[k]) x -= low;
  }
  return out;
}

/// Centres of a ball that turns with a rotary axis: lengths over an angle.
inline bool of_ball_centres(const Observations& o) {
  return !o.angular && !o.axes.empty() && o.axes.front().rotary;
}

/// Whether coordinate k changes within a line whose readings sense direction `error`: else its zero
/// takes whatever depends on k. `away`: looks only at readings that are away from the corner along
/// this coordinate.
inline bool varies_where_sensed(const Observations& o, const SpaceReadings& s, std::size_t k,
                                std::size_t error, std::size_t away = 3) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> first(std::max<std::size_t>(o.lines.size(), 1), never);
  for (std::size_t i = 0; i < s.r[k].size(); ++i) {
    if (!std::isfinite(s.r[k][i]) || !(std::fabs(o.sense_of(i)[error]) > 1e-9)) continue;
    if (away < 3 && !(s.lever(away, i) > 1e-9 * s.length[away])) continue;
    double& x = first[o.line.empty() ? 0 : o.line[i]];
    if (!std::isfinite(x)) x = s.r[k][i];
    if (std::fabs(s.r[k][i] - x) > 1e-9 * s.length[k]) return true;
  }
  return false;
}

/// The places of coordinate k that were measured, each once, ascending, m from the corner. What
/// lies nearer than 1e-9 of the length is one.
inline std::vector<double> places_of(const SpaceReadings& s, std::size_t k) {
  std::vector<double> places;
  for (const double x : s.r[k])
    if (std::isfinite(x)) places.push_back(x);
  std::sort(places.begin(), places.end());
  const double near = 1e-9 * s.length[k];
  places.erase(std::unique(places.begin(), places.end(),
                           [near](double a, double b) { return b - a <= near; }),
               places.end());
  return places;
}

/// Numbers of knots for a smooth curve: at most 10, and at least two places for each free value, so
/// that it cannot follow single places.
inline std::vector<double> knots_over(const std::vector<double>& places) {
  std::vector<double> knots;
  for (std::size_t k = 3; k < std::min<std::size_t>(places.size() / 2, 11); ++k)
    knots.push_back(static_cast<double>(k));
  return knots;
}

/// The readings of one line, as it goes through space; without those that do not know where an axis
/// was that the first one knows.
struct SpaceLine {
  using Vector = std::array<double, 3>;
  std::vector<std::size_t> rows;
  std::vector<Vector> way;     ///< of each row from the first one, m
  Vector sense{}, farthest{};  ///< of the first row; the longest way
  double length = 0.0;         ///< of that
  bool straight = true;        ///< all on one straight, but for what files round

  static double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  /// A step diagonal: aside from the direction of sensing, where a flat mirror is, and along it.
  bool goes_in_steps() const { return !straight && std::fabs(dot(farthest, sense)) > 0.5 * length; }
};

inline SpaceLine space_line(const Observations& o, const SpaceReadings& s, std::size_t line) {
  SpaceLine out;
  const auto same_are_known = [&s](std::size_t one, std::size_t other) {
    return std::all_of(s.r.begin(), s.r.end(), [=](const std::vector<double>& r) {
      return r.empty() || std::isfinite(r[one]) == std::isfinite(r[other]);
    });
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    if ((o.line.empty() ? 0 : o.line[i]) != line) continue;
    if (!out.rows.empty() && !same_are_known(i, out.rows.front())) continue;
    out.way.push_back({s.lever(0, i), s.lever(1, i), s.lever(2, i)});
    out.rows.push_back(i);
  }
  if (out.rows.empty()) return out;
  out.sense = o.sense_of(out.rows.front());
  const auto first = out.way.front();
  for (auto& way : out.way) {
    for (std::size_t k = 0; k < 3; ++k) way[k] -= first[k];
    if (const double length = std::sqrt(SpaceLine::dot(way, way)); length > out.length)
      out.length = length, out.farthest = way;
  }
  for (const auto& way : out.way) {
    const auto off = SpaceLine::cross(way, out.farthest);  // times the length
    if (std::sqrt(SpaceLine::dot(off, off)) > 1e-4 * out.length * out.length) out.straight = false;
  }
  return out;
}

inline std::vector<double> finite_or_zero(std::vector<double> x) {
  for (double& v : x)
    if (!std::isfinite(v)) v = 0.0;
  return x;
}

/// Letter of a coordinate, and back: 3 if it is none.
inline char letter_of(std::size_t k) { return "XYZ"[k]; }
inline std::size_t coordinate_of(char letter) {
  return coordinate_of(std::string_view(&letter, 1));
}

}  // namespace nonio
