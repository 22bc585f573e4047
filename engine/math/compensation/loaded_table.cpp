// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/loaded_table.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {
namespace {

/// `part`: distance from point `below`, as a fraction of the interval.
struct Place {
  std::size_t below = 0;
  double part = 0.0;
  bool outside = false;
};

Place place_of(const std::vector<double>& points, double x, LoadedTable::Outside outside) {
  const double first = points.front(), last = points.back();
  if (outside == LoadedTable::Outside::repeats && last > first) {
    const double turn = last - first;
    x = first + std::fmod(std::fmod(x - first, turn) + turn, turn);
  }
  if (points.size() < 2) return {0, 0.0, x != first};
  const bool beyond = x < first || x > last;
  if (beyond && outside != LoadedTable::Outside::continues) x = std::clamp(x, first, last);
  const auto above = std::upper_bound(points.begin() + 1, points.end() - 1, x);
  const auto i = static_cast<std::size_t>(above - points.begin()) - 1;
  return {i, (x - points[i]) / (points[i + 1] - points[i]), beyond};
}

/// Interpolates linearly in each input; the values of the last input are adjacent in memory.
double interpolated(const std::vector<double>& values, std::span<const Place> places,
                    std::span<const std::size_t> sizes, std::size_t from) {
  if (places.empty()) return values[from];
  const auto at = [&](std::size_t i) {
    return interpolated(values, places.subspan(1), sizes.subspan(1), from * sizes[0] + i);
  };
  const Place& p = places.front();
  const double low = at(p.below);
  return p.part == 0.0 ? low : low + p.part * (at(p.below + 1) - low);
}

}  // namespace

double added(const LoadedTable& table, std::span<const double> at, int direction) {
  std::vector<Place> places;
  std::vector<std::size_t> sizes;
  for (std::size_t k = 0; k < table.position.size(); ++k) {
    places.push_back(place_of(table.position[k], at[k], table.outside));
    sizes.push_back(table.position[k].size());
    if (places.back().outside && table.outside == LoadedTable::Outside::zero) return 0.0;
  }
  const bool own = direction < 0 && !table.minus.empty();
  return interpolated(own ? table.minus : table.plus, places, sizes, 0);
}

double added(const std::vector<LoadedTable>& tables, std::string_view output,
             const std::map<std::string, double>& at, const std::map<std::string, int>& direction) {
  double sum = 0.0;
  for (const LoadedTable& t : tables) {
    if (t.output != output) continue;
    std::vector<double> x;
    for (const std::string& input : t.input)
      if (const auto it = at.find(input); it != at.end()) x.push_back(it->second);
    if (x.size() != t.input.size()) continue;
    const auto towards = direction.find(t.input.front());
    sum += added(t, x, towards == direction.end() ? 1 : towards->second);
  }
  return sum;
}

std::optional<Correction> correction_of(const std::vector<LoadedTable>& tables,
                                        std::string_view axis, double present) {
  std::vector<LoadedTable> own;
  for (const LoadedTable& t : tables)
    if (t.output == axis && t.input.size() == 1 && t.input.front() == axis) own.push_back(t);
  if (own.empty()) return std::nullopt;
  double backlash = present;
  for (const LoadedTable& t : own) backlash = t.backlash.value_or(backlash);
  return [own, backlash](double x, int direction) {
    double c = direction > 0 ? backlash / 2.0 : -backlash / 2.0;
    for (const LoadedTable& t : own) c += added(t, std::span(&x, 1), direction);
    return c;
  };
}

Expected<void> validate_table(const LoadedTable& t) {
  const auto finite = [](const std::vector<double>& v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
  };
  if (t.input.empty() || t.input.size() != t.position.size())
    return fail("a table of " + t.output + " without a position");
  std::size_t points = 1;
  for (const auto& p : t.position) {
    if (p.empty() || !finite(p)) return fail("a table of " + t.output + " without points");
    for (std::size_t i = 1; i < p.size(); ++i)
      if (!(p[i] > p[i - 1])) return fail("positions of the table of " + t.output + " do not rise");
    points *= p.size();
  }
  if (t.plus.size() != points || !finite(t.plus) || !finite(t.minus) ||
      (!t.minus.empty() && t.minus.size() != points))
    return fail("the table of " + t.output + " has " + std::to_string(t.plus.size()) +
                " numbers for " + std::to_string(points) + " points");
  if (t.outside == LoadedTable::Outside::repeats && t.input.size() == 1)
    for (const auto* v : {&t.plus, &t.minus})
      if (!v->empty() && std::fabs(v->front() - v->back()) > 1e-12)
        return fail("the table of " + t.output + " repeats and its ends differ: a jump each turn");
  return {};
}

}  // namespace nonio::math
