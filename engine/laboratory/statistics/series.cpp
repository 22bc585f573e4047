// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/series.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "laboratory/statistics/gls.h"

namespace nonio::statistics {
namespace {

// median of chi-square with 1 degree of freedom
constexpr double median_of_chi2 = 0.45493642311957;
constexpr std::size_t fewest_ratios = 20;

/// Returns the ratio of `Scatter`. std::nullopt if an event other than a change of the instrument
/// is declared next to the point, or if its neighbors have equal times.
std::optional<double> off_line(const Series& s, std::size_t i) {
  for (const Declared& d : s.declared)
    if (d.kind != Declared::Kind::instrument && (d.after == i || d.after + 1 == i))
      return std::nullopt;
  const double whole = s.points[i + 1].time - s.points[i - 1].time;
  if (!(whole > 0.0)) return std::nullopt;
  const double share = (s.points[i].time - s.points[i - 1].time) / whole;
  const double weights[] = {share - 1.0, 1.0, -share};
  double off = 0.0, variance = 0.0;
  std::map<std::string, double> common;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& p = s.points[i - 1 + k];
    off += weights[k] * p.value;
    variance += weights[k] * weights[k] * p.u * p.u;
    for (const Common& c : p.common) common[c.source] += weights[k] * c.u;
  }
  for (const auto& [source, u] : common) variance += u * u;
  return off * off / variance;
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
      return fail("an event after " + which(d.after) + ": expected a point after it");
  for (const std::size_t after : s.steps.value_or(std::vector<std::size_t>{}))
    if (after + 1 >= s.points.size())
      return fail("a step after " + which(after) + ": expected a point after it");
  if (!std::isfinite(s.spread) || s.spread < 0.0)
    return fail("expected a spread of slopes of 0 or more");
  if (!std::isfinite(s.excess) || s.excess < 1.0) return fail("expected an excess of 1 or more");
  return {};
}

std::vector<Scatter> scatter_of(const Series& s) {
  std::vector<Scatter> out;
  for (std::size_t i = 1; i + 1 < s.points.size(); ++i)
    if (const auto ratio = off_line(s, i)) out.push_back({i, *ratio});
  return out;
}

double excess_of_ratios(std::vector<double> ratios) {
  if (ratios.size() < fewest_ratios) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::max(1.0, std::sqrt(*middle / median_of_chi2));
}

double p_of_ratios(const std::vector<double>& ratios) {
  if (ratios.empty()) return 1.0;
  constexpr double overdispersion = 1.5;
  const auto n = static_cast<double>(ratios.size());
  const auto above = static_cast<double>(std::count_if(
      ratios.begin(), ratios.end(), [](double ratio) { return ratio > median_of_chi2; }));
  return normal_upper((above - 0.5 - 0.5 * n) / std::sqrt(0.25 * overdispersion * n));
}

}  // namespace nonio::statistics
