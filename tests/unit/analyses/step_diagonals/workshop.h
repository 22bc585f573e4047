// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "machine.h"
#include "nonio/math/step_diagonals.h"

/// Step diagonals of the exact machine.
namespace steps {

using machine::Vector;
using nonio::math::StepDiagonals;
inline constexpr double um = 1e-6, urad = 1e-6;

struct Volume {
  Vector travel{0.8, 0.6, 0.6};
  std::size_t n = 40;
};

/// Alignment of the optics in one pass: the mirror to the beam, the beam to the diagonal.
struct Optics {
  Eigen::Vector2d mirror{0, 0}, beam{0, 0};  ///< rad
};

inline const std::vector<std::array<int, 3>>& four() {
  static const std::vector<std::array<int, 3>> signs{{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
  return signs;
}

inline StepDiagonals empty(const Volume& v) {
  StepDiagonals d;
  d.travel = {v.travel.x(), v.travel.y(), v.travel.z()};
  d.n = v.n;
  for (const auto& sign : four()) d.passes.push_back({sign, std::vector<double>(3 * v.n, 0.0)});
  return d;
}

inline std::vector<Vector> stops(const StepDiagonals& d, const StepDiagonals::Pass& pass) {
  std::vector<Vector> out;
  for (std::size_t t = 0; t <= 3 * d.n; ++t) {
    const auto moves = d.counts(t);
    Vector p;
    for (std::size_t k = 0; k < 3; ++k)
      p[static_cast<Eigen::Index>(k)] = d.position(k, pass.sign[k] > 0 ? moves[k] : d.n - moves[k]);
    out.push_back(p);
  }
  return out;
}

inline StepDiagonals measured(const machine::Errors& errors, const Volume& v,
                              const std::vector<Optics>& set_up = std::vector<Optics>(4)) {
  StepDiagonals d = empty(v);
  for (std::size_t k = 0; k < d.passes.size(); ++k) {
    const auto places = stops(d, d.passes[k]);
    Vector u = v.travel.normalized();
    for (Eigen::Index c = 0; c < 3; ++c) u[c] *= d.passes[k].sign[static_cast<std::size_t>(c)];
    const Vector one = u.unitOrthogonal();
    const Vector beam =
        (u + one * set_up[k].beam[0] + u.cross(one) * set_up[k].beam[1]).normalized();
    const auto read = machine::flat_mirror(errors, places, beam, set_up[k].mirror);
    for (std::size_t t = 1; t < places.size(); ++t)
      d.passes[k].reading[t - 1] = read[t] + (places[t] - places[0]).dot(beam - u);
  }
  return d;
}

/// Positioning of the axes as machine curves; u: their noise as told to the fit.
inline std::vector<nonio::math::AxisSeries> lengths(machine::Errors e, const Volume& v,
                                                    const std::string& axes, double u = 0.0) {
  std::vector<nonio::math::AxisSeries> out;
  for (const char axis : axes) {
    nonio::math::AxisSeries s{static_cast<std::size_t>(axis - 'X'), {}, {}, u};
    const double travel = v.travel[axis - 'X'];
    for (std::size_t i = 0; i <= v.n; ++i) {
      s.position.push_back(travel * static_cast<double>(i) / static_cast<double>(v.n));
      s.deviation.push_back(e[std::string("E") + axis + axis](s.position.back()));
    }
    out.push_back(s);
  }
  return out;
}

/// Smooth, 0 at 0, of some um.
inline machine::Curve random_curve(std::mt19937& rng, double size, double travel) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const double a = size * u(rng), b = size * u(rng), c = size * u(rng), f = 3.0 + 3.0 * u(rng);
  return [=](double p) {
    const double t = p / travel;
    return a * t + b * t * t + c * std::sin(f * t);
  };
}

inline machine::Errors random_errors(std::mt19937& rng, const Volume& v, double size) {
  machine::Errors e;
  for (const char axis : {'X', 'Y', 'Z'})
    for (const char along : {'X', 'Y', 'Z'})
      e[std::string("E") + along + axis] = random_curve(rng, size, v.travel[axis - 'X']);
  std::uniform_real_distribution<double> u(-30 * urad, 30 * urad);
  e.C0Y = u(rng);
  e.B0Z = u(rng);
  e.A0Z = u(rng);
  return e;
}

/// Least-squares line of values at even places: slope per place, and the values without it.
inline double slope_of(const std::vector<double>& y) {
  const double m = static_cast<double>(y.size()), c = (m - 1.0) / 2.0;
  double sxy = 0.0, sxx = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double x = static_cast<double>(i) - c;
    sxy += x * y[i];
    sxx += x * x;
  }
  return sxy / sxx;
}
inline std::vector<double> levelled(std::vector<double> y) {
  const double s = slope_of(y), c = (static_cast<double>(y.size()) - 1.0) / 2.0;
  double mean = 0.0;
  for (const double v : y) mean += v / static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] -= mean + s * (static_cast<double>(i) - c);
  return y;
}

inline std::vector<double> sampled(const machine::Curve& curve, double travel, std::size_t n) {
  std::vector<double> y;
  for (std::size_t i = 0; i <= n; ++i)
    y.push_back(curve(travel * static_cast<double>(i) / static_cast<double>(n)));
  return y;
}

/// What a solution should say of this machine.
inline std::vector<double> truth(machine::Errors e, const Volume& v,
                                 const nonio::math::StepCurve& c) {
  auto y = sampled(e[c.name], v.travel[static_cast<Eigen::Index>(c.axis)], v.n);
  if (c.name[1] != c.name[2]) return levelled(y);
  const double first = y.front(),
               last = c.known ? 0.0 : (y.back() - first) / static_cast<double>(v.n);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] -= first + last * static_cast<double>(i);
  return y;
}

inline std::array<double, 3> true_squareness(machine::Errors e, const Volume& v) {
  const auto slope = [&](const char* name) {
    const double travel = v.travel[name[2] - 'X'];
    return slope_of(sampled(e[name], travel, v.n)) * static_cast<double>(v.n) / travel;
  };
  return {e.C0Y - slope("EYX") - slope("EXY"), e.B0Z + slope("EZX") + slope("EXZ"),
          e.A0Z - slope("EZY") - slope("EYZ")};
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) return 1e300;
    most = std::max(most, std::fabs(a[i] - b[i]));
  }
  return a.size() == b.size() && !a.empty() ? most : 1e300;
}

inline void expect_truth(const nonio::math::StepSolution& s, const machine::Errors& e,
                         const Volume& v, double within, double angle_within) {
  for (const auto& c : s.curves)
    EXPECT_LT(largest_difference(c.value, truth(e, v, c)), within) << c.name;
  const auto square = true_squareness(e, v);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(s.squareness[k].value, square[k], angle_within) << k;
}

inline std::vector<Optics> random_set_up(std::mt19937& rng, double angle, bool beam) {
  std::uniform_real_distribution<double> u(-angle / std::sqrt(2.0), angle / std::sqrt(2.0));
  std::vector<Optics> out(4);
  for (Optics& s : out) (beam ? s.beam : s.mirror) = Eigen::Vector2d(u(rng), u(rng));
  return out;
}

}  // namespace steps
