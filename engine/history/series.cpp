// SPDX-License-Identifier: Apache-2.0
#include "nonio/history/series.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace nonio::history {
namespace {

constexpr double median_of_chi2 = 0.45493642311957;  // with 1 degree of freedom
constexpr std::size_t fewest_differences = 20;

/// Variance of the difference of two points: what they have in common cancels.
double variance_of_difference(const Point& a, const Point& b) {
  std::map<std::string, double> left;
  for (const Common& c : a.common) left[c.source] -= c.u;
  for (const Common& c : b.common) left[c.source] += c.u;
  double out = a.u * a.u + b.u * b.u;
  for (const auto& [source, u] : left) out += u * u;
  return out;
}

std::string which(std::size_t i) { return "point " + std::to_string(i + 1); }

}  // namespace

Expected<void> check(const Series& s) {
  if (s.points.empty()) return fail("expected points, found none");
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const Point& p = s.points[i];
    if (!std::isfinite(p.time) || !std::isfinite(p.value))
      return fail(which(i) + ": expected a time and a value, found what is not a number");
    if (!std::isfinite(p.u) || !(p.u > 0.0))
      return fail(which(i) + ": expected an uncertainty above 0");
    for (const Common& c : p.common)
      if (!std::isfinite(c.u))
        return fail(which(i) + ": expected the uncertainty of " + c.source + ", found none");
    if (i > 0 && p.time < s.points[i - 1].time)
      return fail(which(i) + ": expected a time not before that of " + which(i - 1));
  }
  for (const Declared& d : s.declared)
    if (d.after + 1 >= s.points.size())
      return fail("an event behind " + which(d.after) + ": expected a point after it");
  if (!std::isfinite(s.excess) || s.excess < 1.0) return fail("expected an excess of 1 or more");
  return {};
}

double excess_scatter(const std::vector<const Series*>& all) {
  std::vector<double> ratios;
  for (const Series* s : all)
    for (std::size_t i = 0; i + 1 < s->points.size(); ++i) {
      if (std::any_of(s->declared.begin(), s->declared.end(),
                      [&](const Declared& d) { return d.after == i; }))
        continue;
      const double d = s->points[i + 1].value - s->points[i].value;
      ratios.push_back(d * d / variance_of_difference(s->points[i], s->points[i + 1]));
    }
  if (ratios.size() < fewest_differences) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::max(1.0, std::sqrt(*middle / median_of_chi2));
}

}  // namespace nonio::history
