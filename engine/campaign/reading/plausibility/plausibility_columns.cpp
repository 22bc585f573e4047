// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "nonio/math/rotary.h"

namespace nonio::reading {
namespace {

struct Climate {
  double mean = 0.0, range = 0.0;
  bool known = false;
};

Climate climate_of(const std::vector<double>& column) {
  double sum = 0.0, n = 0.0, low = 0.0, high = 0.0;
  for (const double v : column) {
    if (!std::isfinite(v)) continue;
    low = n == 0.0 ? v : std::min(low, v);
    high = n == 0.0 ? v : std::max(high, v);
    sum += v;
    n += 1.0;
  }
  return n == 0.0 ? Climate{} : Climate{sum / n, high - low, true};
}

void implausible_air(const Observations& o, std::vector<Finding>& out) {
  // Temperatures in degC, humidity in %.
  constexpr double coldest = 5.0, hottest = 45.0, driest = 3.0;
  struct Column {
    const char* name;
    const std::vector<double>& values;
    Quantity mean, range;
    double most;  ///< largest plausible range within one measurement, in the unit of the column
  };
  for (const Column& c :
       {Column{"material_c", o.material, Quantity::temperature, Quantity::temperature_difference,
               10},
        Column{"air_c", o.air, Quantity::temperature, Quantity::temperature_difference, 15},
        Column{"pressure_hpa", o.pressure, Quantity::number, Quantity::number, 40},
        Column{"humidity_pct", o.humidity, Quantity::number, Quantity::number, 60}}) {
    const Climate found = climate_of(c.values);
    if (!found.known) continue;
    const bool temperature = c.mean == Quantity::temperature;
    if (temperature && (found.mean < coldest || found.mean > hottest))
      out.push_back({.id = "plausibility.temperature",
                     .attention = true,
                     .evidence = {{"mean", found.mean, Quantity::temperature}},
                     .texts = {{"column", c.name}}});
    if (&c.values == &o.humidity && found.mean < driest)
      out.push_back({.id = "plausibility.humidity",
                     .attention = true,
                     .evidence = {{"mean", found.mean, Quantity::number}},
                     .texts = {{"column", c.name}}});
    if (found.range > c.most)
      out.push_back({.id = "plausibility.environment-varies",
                     .attention = true,
                     .evidence = {{"range", found.range, c.range}, {"most", c.most, c.range}},
                     .texts = {{"column", c.name}}});
  }
}

/// Compares times with the dwell, the feed, the distances, and the order of the rows.
void implausible_times(const Measurement& m, const std::vector<Stroke>& strokes,
                       const Observations& o, std::vector<Finding>& out) {
  constexpr double slowest = 3600.0;  // longest plausible time for one reading, s
  constexpr double fastest = 5.0, fastest_angle = 600.0;  // largest plausible speeds, m/s and rad/s
  std::vector<std::pair<double, double>> taken;
  const auto& axis = o.axes.front();
  for (std::size_t i = 0; i < o.time.size(); ++i)
    if (std::isfinite(o.time[i])) taken.emplace_back(o.time[i], axis.position[i]);
  if (taken.size() < 4) return;
  std::stable_sort(taken.begin(), taken.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  double way = 0.0;
  for (std::size_t i = 1; i < taken.size(); ++i)
    way += std::fabs(taken[i].second - taken[i - 1].second);
  const double lasted = taken.back().first - taken.front().first;
  const double each = lasted / static_cast<double>(taken.size() - 1);
  // Factors for times below the dwell, and speeds above the feed.
  constexpr double shorter = 0.9, faster = 1.1;
  if (lasted > 0.0 &&
      ((m.dwell && each < shorter * *m.dwell) || (m.feed && way > faster * *m.feed * lasted)))
    out.push_back({.id = "plausibility.pace-against-test",
                   .attention = true,
                   .evidence = {{"readings", static_cast<double>(taken.size()), Quantity::count},
                                {"lasted", lasted, Quantity::time},
                                {"way", way, axis.rotary ? Quantity::angle : Quantity::length},
                                {"dwell", m.dwell.value_or(0.0), Quantity::time}}});
  else if (each > slowest || way > (axis.rotary ? fastest_angle : fastest) * lasted)
    out.push_back({.id = "plausibility.pace",
                   .attention = true,
                   .evidence = {{"readings", static_cast<double>(taken.size()), Quantity::count},
                                {"lasted", lasted, Quantity::time},
                                {"way", way, axis.rotary ? Quantity::angle : Quantity::length}}});
  if (taken.size() != o.size()) return;
  std::string which;
  double torn = 0.0;
  for (const Stroke& s : strokes)
    if (s.alone_in_file && !s.alone) {
      if (which.empty()) which = name_of(s);
      torn += 1.0;
    }
  if (torn > 0.0)
    out.push_back({.id = "plausibility.times-against-order",
                   .attention = true,
                   .evidence = {{"passes", torn, Quantity::count},
                                {"of", static_cast<double>(strokes.size()), Quantity::count}},
                   .texts = {{"which", which}}});
}

std::vector<std::array<double, 3>> centres_of(const Observations& o) {
  std::vector<std::array<double, 3>> centres;
  for (std::size_t i = 0; i + 2 < o.size(); i += 3)
    centres.push_back({o.deviation[i], o.deviation[i + 1], o.deviation[i + 2]});
  return centres;
}

double apart(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Returns the normal of the plane through the first center and the two centers that span the
/// largest area; 0 if all centers are collinear.
std::array<double, 3> normal_of(const std::vector<std::array<double, 3>>& centres) {
  std::array<double, 3> best{};
  double size = 0.0;
  const auto& o = centres.front();
  for (std::size_t i = 1; i < centres.size(); ++i)
    for (std::size_t k = i + 1; k < centres.size(); ++k) {
      const auto &a = centres[i], &b = centres[k];
      const std::array<double, 3> n{(a[1] - o[1]) * (b[2] - o[2]) - (a[2] - o[2]) * (b[1] - o[1]),
                                    (a[2] - o[2]) * (b[0] - o[0]) - (a[0] - o[0]) * (b[2] - o[2]),
                                    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])};
      const double length = std::hypot(n[0], n[1], n[2]);
      if (length > size) size = length, best = n;
    }
  for (double& x : best) x = size > 0.0 ? x / size : 0.0;
  return best;
}

}  // namespace

void implausible_columns(const Measurement& m, const Passes& passes, const Observations& o,
                         bool with_times, std::vector<Finding>& out) {
  implausible_air(o, out);
  if (with_times) implausible_times(m, passes.strokes, o, out);
}

void implausible_centres(const Measurement& m, const Observations& o, std::vector<Finding>& out) {
  constexpr double nearest = 0.04, farthest = 10.0;  // distances between ball centers, m
  constexpr std::size_t most = 200;
  auto centres = centres_of(o);
  if (centres.size() < 3) return;
  if (centres.size() > most) centres.resize(most);
  double span = 0.0;
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (std::size_t k = i + 1; k < centres.size(); ++k)
      span = std::max(span, apart(centres[i], centres[k]));
  if (span < nearest || span > farthest)
    return out.push_back({.id = "plausibility.ball-circle",
                          .attention = true,
                          .evidence = {{"span", span, Quantity::length},
                                       {"least", nearest, Quantity::length},
                                       {"most", farthest, Quantity::length}}});
  const std::size_t named = m.axis.empty() ? std::string::npos : std::string("ABC").find(m.axis[0]);
  if (named == std::string::npos || !math::other_turning_axis(o).empty()) return;
  const double cosine = std::fabs(normal_of(centres)[named]);
  constexpr double least = 0.5;  // cosine of 60 deg; swiveling axes are mounted at 45 deg
  if (cosine < least)
    out.push_back({.id = "plausibility.axis-direction",
                   .attention = true,
                   .evidence = {{"angle", std::acos(cosine), Quantity::angle}},
                   .texts = {{"axis", m.axis}, {"along", std::string(1, "XYZ"[named])}}});
}

}  // namespace nonio::reading
