// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "machine.h"
#include "nonio/math/diagonals.h"

/// What an interferometer reads on the exact machine, as the kernel of diagonals takes it.
namespace bench {

using machine::Errors;
using nonio::math::DiagonalReadings;
using nonio::math::DirectStraightness;
using nonio::math::GridLine;
using nonio::math::MeanCurve;
using nonio::math::PitchLine;

inline constexpr double um = 1e-6;

struct Rectangle {
  double Lx = 12.0, Ly = 9.0;
  std::size_t n = 30;
  double x(std::size_t i) const { return Lx * static_cast<double>(i) / static_cast<double>(n); }
  double y(std::size_t i) const { return Ly * static_cast<double>(i) / static_cast<double>(n); }
};

inline GridLine line(const Errors& e, const Rectangle& r, std::vector<std::size_t> ix,
                     std::vector<std::size_t> iy) {
  GridLine out;
  std::vector<machine::Vector> stops;
  for (std::size_t j = 0; j < ix.size(); ++j) stops.emplace_back(r.x(ix[j]), r.y(iy[j]), 0.0);
  out.mean = machine::interferometer(e, stops);
  const machine::Vector way = (stops.back() - stops.front()).normalized();
  out.cx = way.x();
  out.cy = way.y();
  out.ix = std::move(ix);
  out.iy = std::move(iy);
  return out;
}

inline std::vector<std::size_t> count(std::size_t n, std::size_t step = 1, std::size_t first = 0) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; first + i * step <= n; ++i) out.push_back(first + i * step);
  return out;
}

inline std::vector<std::size_t> down(std::size_t n) {
  auto out = count(n);
  for (std::size_t& i : out) i = n - i;
  return out;
}

/// Positioning of X on the line y, measured by an interferometer.
inline PitchLine pitch_x(const Errors& e, const Rectangle& r, double y) {
  PitchLine out;
  out.across = y;
  std::vector<machine::Vector> stops;
  for (const std::size_t i : count(r.n)) stops.emplace_back(r.x(i), y, 0.0);
  out.mean = machine::interferometer(e, stops);
  return out;
}

inline PitchLine pitch_y(const Errors& e, const Rectangle& r) {
  PitchLine out;
  std::vector<machine::Vector> stops;
  for (const std::size_t i : count(r.n)) stops.emplace_back(0.0, r.y(i), 0.0);
  out.mean = machine::interferometer(e, stops);
  return out;
}

/// Both diagonals, X on these lines, Y.
inline DiagonalReadings read(const Errors& e, const Rectangle& r,
                             const std::vector<double>& x_lines) {
  DiagonalReadings d;
  d.Lx = r.Lx;
  d.Ly = r.Ly;
  d.n = r.n;
  d.D1 = line(e, r, count(r.n), count(r.n));
  d.D2 = line(e, r, count(r.n), down(r.n));
  for (const double y : x_lines) d.X.push_back(pitch_x(e, r, y));
  d.Y = {pitch_y(e, r)};
  return d;
}

inline GridLine half_diagonal(const Errors& e, const Rectangle& r) {
  return line(e, r, count(r.n, 2), count(r.n / 2));
}

inline GridLine parallel_diagonal(const Errors& e, const Rectangle& r, std::size_t start) {
  return line(e, r, count(r.n, 1, start), count(r.n - start));
}

/// Straightness along the axis' stops, as a straightedge with an unknown line gives it.
inline DirectStraightness straightness(const machine::Curve& curve, double length, std::size_t n) {
  DirectStraightness out;
  for (std::size_t i = 0; i <= n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n);
    out.mean.push_back(curve(length * t) + 7e-6 - 11e-6 * t);
  }
  out.zeroed = false;
  return out;
}

/// Sines of 1 to 4 half waves: even and odd about mid-travel, 0 at both ends.
inline machine::Curve random_curve(std::mt19937& rng, double length, double size) {
  std::normal_distribution<double> normal;
  std::vector<double> a;
  for (int m = 1; m <= 4; ++m) a.push_back(size * normal(rng) / m);
  return [a, length](double p) {
    double sum = 0.0;
    for (std::size_t m = 0; m < a.size(); ++m)
      sum += a[m] * std::sin(static_cast<double>(m + 1) * std::numbers::pi * p / length);
    return sum;
  };
}

/// A gantry with about this much error in each of the six functions of the plane.
inline Errors random_gantry(std::mt19937& rng, const Rectangle& r, double size = 20 * um) {
  Errors e;
  e.EXX = random_curve(rng, r.Lx, size);
  e.EYY = random_curve(rng, r.Ly, size);
  e.EYX = random_curve(rng, r.Lx, size);
  e.EXY = random_curve(rng, r.Ly, size);
  e.ECX = random_curve(rng, r.Lx, size / 10.0);
  e.C0Y = size / 2.0;
  e.y_ref = 0.5;
  return e;
}

}  // namespace bench
