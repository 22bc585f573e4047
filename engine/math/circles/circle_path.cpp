// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "common/constants.h"
#include "eigen/dense.h"
#include "nonio/math/circle.h"

namespace nonio::math {

namespace {

using PathReadings = std::span<const CircleReading>;
using Centre = std::array<double, 2>;

/// Returns the distance from a center minus R, without the cancellation of hypot(...) - R.
double radial(const CircleReading& r, double R, const Centre& c) {
  const double s = std::sin(r.angle), k = std::cos(r.angle), rho = R + r.deviation;
  // |P - c|^2 - R^2 = (rho - R)(rho + R) - 2 rho (c . n) + |c|^2
  const double square =
      r.deviation * (rho + R) - 2.0 * rho * (c[0] * k + c[1] * s) + c[0] * c[0] + c[1] * c[1];
  return square / (std::sqrt(R * R + square) + R);
}

/// Nested golden sections, because the width is convex except for terms of second order.
class Few {
 public:
  Few(PathReadings all, const std::vector<std::size_t>& which, double R)
      : all_(all), which_(which), R_(R) {}

  Centre best(Centre from, double reach) const {
    const double a = golden(from[0] - reach, from[0] + reach, [&](double x) {
      return width({x, best_second(x, from[1], reach)});
    });
    return {a, best_second(a, from[1], reach)};
  }
  double width(const Centre& c) const {
    double low = INFINITY, high = -INFINITY;
    for (const std::size_t i : which_) {
      const double x = radial(all_[i], R_, c);
      low = std::min(low, x), high = std::max(high, x);
    }
    return high - low;
  }

 private:
  double best_second(double a, double from, double reach) const {
    return golden(from - reach, from + reach, [&](double b) { return width({a, b}); });
  }
  template <class F>
  static double golden(double low, double high, F f) {
    constexpr double g = 0.6180339887498949;
    const double enough = 1e-7 * (high - low) + 1e-15;
    double x1 = high - g * (high - low), x2 = low + g * (high - low);
    double f1 = f(x1), f2 = f(x2);
    while (high - low > enough) {
      if (f1 <= f2) {
        high = x2, x2 = x1, f2 = f1, x1 = high - g * (high - low), f1 = f(x1);
      } else {
        low = x1, x1 = x2, f1 = f2, x2 = low + g * (high - low), f2 = f(x2);
      }
    }
    return 0.5 * (low + high);
  }

  PathReadings all_;
  const std::vector<std::size_t>& which_;
  double R_;
};

}  // namespace

PathCircle about(PathReadings readings, double R, Centre centre) {
  PathCircle out;
  out.centre = centre;
  out.inner = INFINITY, out.outer = -INFINITY;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const double x = radial(readings[i], R, centre);
    out.radius += x / static_cast<double>(readings.size());
    if (x < out.inner) out.inner = x, out.innermost = i;
    if (x > out.outer) out.outer = x, out.outermost = i;
  }
  return out;
}

PathCircle least_squares_circle(PathReadings readings, double R) {
  Centre c{};
  double radius = 0.0;
  for (int step = 0; step < 4; ++step) {
    Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    for (const CircleReading& r : readings) {
      const double rho = R + r.deviation, x = rho * std::cos(r.angle) - c[0],
                   z = rho * std::sin(r.angle) - c[1], size = std::hypot(x, z);
      const Eigen::Vector3d row(x / size, z / size, 1.0);
      N += row * row.transpose();
      y += row * (radial(r, R, c) - radius);
    }
    const Eigen::Vector3d move = N.ldlt().solve(y);
    c[0] += move[0], c[1] += move[1], radius += move[2];
  }
  return about(readings, R, c);
}

PathCircle minimum_zone(PathReadings readings, double R) {
  PathCircle best = least_squares_circle(readings, R);
  if (readings.size() < 4 || !(best.width() > 0.0)) return best;
  // Four readings define the zone; add readings until none is outside of it.
  std::vector<std::size_t> few{best.innermost, best.outermost};
  for (int q = 0; q < 8; ++q) {
    double low = INFINITY, high = -INFINITY;
    std::size_t i_low = 0, i_high = 0;
    bool any = false;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const double within =
          readings[i].angle - full_turn * std::floor(readings[i].angle / full_turn);
      if (static_cast<int>(within / full_turn * 8.0) % 8 != q) continue;
      const double x = radial(readings[i], R, best.centre);
      any = true;
      if (x < low) low = x, i_low = i;
      if (x > high) high = x, i_high = i;
    }
    if (any) few.push_back(i_low), few.push_back(i_high);
  }
  const double reach = best.width();
  const Centre from = best.centre;
  for (int step = 0; step < 40; ++step) {
    const Few problem(readings, few, R);
    const Centre centre = problem.best(from, reach);
    const PathCircle all = about(readings, R, centre);
    if (all.width() < best.width()) best = all;
    // The zone of these readings is a lower bound for that of the whole path.
    if (all.width() - problem.width(centre) <= 1e-6 * reach) break;
    few.push_back(all.innermost), few.push_back(all.outermost);
  }
  return best;
}

std::optional<Hysteresis> circular_hysteresis(PathReadings readings, double R, Centre centre,
                                              double step) {
  std::map<double, double> back;
  for (const CircleReading& r : readings)
    if (r.direction < 0)
      back[r.angle - full_turn * std::floor(r.angle / full_turn)] = radial(r, R, centre);
  if (back.empty()) return std::nullopt;
  std::optional<Hysteresis> out;
  const auto take = [&](double distance, double angle) {
    if (!out || distance > out->H) out = Hysteresis{distance, angle};
  };
  for (const CircleReading& r : readings) {
    if (r.direction < 0) continue;
    const double t = r.angle - full_turn * std::floor(r.angle / full_turn);
    auto above = back.lower_bound(t);
    const bool last = above == back.end(), first = above == back.begin();
    const auto below = first ? std::prev(back.end()) : std::prev(above);
    const double t1 = below->first - (first ? full_turn : 0.0);
    if (last) above = back.begin();
    const double t2 = above->first + (last ? full_turn : 0.0), here = radial(r, R, centre);
    if (std::fabs(t2 - t) < 1e-9) {
      take(std::fabs(here - above->second), t);
    } else if (t2 - t1 <= step && t2 > t1) {
      const double share = (t - t1) / (t2 - t1);
      take(std::fabs(here - below->second - share * (above->second - below->second)), t);
    }
  }
  return out;
}

}  // namespace nonio::math
