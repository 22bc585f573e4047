// SPDX-License-Identifier: Apache-2.0
//
// The zone width W(b) = max (e_i - b x_i) - min (e_i - b x_i) is convex and piecewise linear in b.
// Its corners, one of which is the minimum, are the slopes of the edges of the two convex hulls.
#include "nonio/math/straightness.h"

#include <array>
#include <cmath>
#include <limits>

namespace nonio::math {
namespace {

using Numbers = std::span<const double>;

/// Returns the indices of the convex hull on one side: 1 above, -1 below.
std::vector<std::size_t> convex_side(Numbers x, Numbers e, double side) {
  std::vector<std::size_t> h;
  for (std::size_t i = 0; i < x.size(); ++i) {
    while (h.size() > 1) {
      const std::size_t p = h[h.size() - 2], q = h.back();
      const double turn = (x[q] - x[p]) * (e[i] - e[p]) - (e[q] - e[p]) * (x[i] - x[p]);
      if (side * turn < 0.0) break;
      h.pop_back();
    }
    h.push_back(i);
  }
  return h;
}

struct Zone {
  std::size_t high = 0, low = 0;
  double width = 0.0;
};

Zone zone_about(Numbers x, Numbers e, double b) {
  Zone found;
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = e[i] - b * (x[i] - x[0]);
    if (d > most) most = d, found.high = i;
    if (d < least) least = d, found.low = i;
  }
  found.width = most - least;
  return found;
}

void fit_least_squares(Straightness& s, Numbers x, Numbers e) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0, mean_e = 0.0, square = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) mean_x += (x[i] - x[0]) / n, mean_e += e[i] / n;
  for (const double p : x) square += (p - x[0] - mean_x) * (p - x[0] - mean_x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    s.slope_by[i] = (x[i] - x[0] - mean_x) / square;
    s.b += s.slope_by[i] * e[i];
  }
  s.a = mean_e - s.b * mean_x;
}

void fit_end_points(Straightness& s, Numbers x, Numbers e) {
  const double length = x.back() - x.front();
  s.slope_by.front() = -1.0 / length;
  s.slope_by.back() = 1.0 / length;
  s.b = (e.back() - e.front()) / length;
  s.a = e.front();
}

void fit_minimum_zone(Straightness& s, Numbers x, Numbers e) {
  double best = std::numeric_limits<double>::infinity();
  std::array<std::size_t, 2> edge{};
  for (const double side : {1.0, -1.0}) {
    const auto h = convex_side(x, e, side);
    for (std::size_t k = 1; k < h.size(); ++k) {
      const double slope = (e[h[k]] - e[h[k - 1]]) / (x[h[k]] - x[h[k - 1]]);
      const double width = zone_about(x, e, slope).width;
      if (width < best) best = width, s.b = slope, edge = {h[k - 1], h[k]};
    }
  }
  const double length = x[edge[1]] - x[edge[0]];
  s.slope_by[edge[0]] = -1.0 / length;
  s.slope_by[edge[1]] = 1.0 / length;
  const Zone zone = zone_about(x, e, s.b);
  s.a =
      (e[zone.high] - s.b * (x[zone.high] - x[0]) + e[zone.low] - s.b * (x[zone.low] - x[0])) / 2.0;
}

}  // namespace

Expected<Straightness> straightness_about(StraightLine line, Numbers x, Numbers e) {
  if (x.size() < 3 || x.size() != e.size())
    return fail("straightness: expected at least three positions with a deviation each, found " +
                std::to_string(x.size()) + " and " + std::to_string(e.size()));
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!std::isfinite(x[i]) || !std::isfinite(e[i]) || (i > 0 && !(x[i] > x[i - 1])))
      return fail("straightness: expected finite values at ascending positions");
  Straightness s;
  s.slope_by.assign(x.size(), 0.0);
  s.width_by.assign(x.size(), 0.0);
  switch (line) {
    case StraightLine::least_squares:
      fit_least_squares(s, x, e);
      break;
    case StraightLine::minimum_zone:
      fit_minimum_zone(s, x, e);
      break;
    case StraightLine::end_points:
      fit_end_points(s, x, e);
      break;
  }
  const Zone zone = zone_about(x, e, s.b);
  s.width = zone.width;
  for (std::size_t i = 0; i < x.size(); ++i) {
    s.rest.push_back(e[i] - s.a - s.b * (x[i] - x[0]));
    s.width_by[i] -= s.slope_by[i] * (x[zone.high] - x[zone.low]);
  }
  s.width_by[zone.high] += 1.0;
  s.width_by[zone.low] -= 1.0;
  return s;
}

std::vector<double> integrated(Numbers angles, double foot) {
  std::vector<double> e{0.0};
  for (const double angle : angles) e.push_back(e.back() + foot * angle);
  return e;
}

}  // namespace nonio::math
