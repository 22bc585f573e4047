// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"

namespace nonio::reading {
namespace {

/// Strokes that go up and are called -, or down and are called +. A file that is sorted by target,
/// with strokes mixed or all going one way, says nothing of it; nor do targets that all were
/// approached from one side, whichever came first.
void against_order(const std::vector<Stroke>& strokes, std::vector<Finding>& out) {
  bool up = false, down = false, plus = false, minus = false;
  std::size_t judged = 0;
  std::vector<const Stroke*> wrong;
  for (const Stroke& s : strokes) {
    if (!s.alone || s.sense == 0 || s.direction == 0) continue;
    (s.sense > 0 ? up : down) = true;
    (s.direction > 0 ? plus : minus) = true;
    ++judged;
    if (s.sense != s.direction) wrong.push_back(&s);
  }
  if (!up || !down || !plus || !minus || wrong.empty()) return;
  out.push_back({.id = "plausibility.direction-against-order",
                 .attention = true,
                 .evidence = {{"passes", static_cast<double>(wrong.size()), Quantity::count},
                              {"of", static_cast<double>(judged), Quantity::count}},
                 .texts = {{"which", name_of(*wrong.front())}}});
}

using Reversals = std::map<std::uint32_t, std::map<double, double>>;  // by run and target

Reversals reversals_of(const std::vector<Stroke>& strokes) {
  std::map<std::uint32_t, const Stroke*> plus, minus;
  for (const Stroke& s : strokes) (s.direction > 0 ? plus : minus)[s.run] = &s;
  Reversals out;
  for (const auto& [run, up] : plus) {
    const auto down = minus.find(run);
    if (down == minus.end()) continue;
    std::map<double, double> by_target;
    for (std::size_t i = 0; i < up->target.size(); ++i) by_target[up->target[i]] = up->deviation[i];
    for (std::size_t i = 0; i < down->second->target.size(); ++i)
      if (const auto at = by_target.find(down->second->target[i]); at != by_target.end())
        out[run][at->first] = at->second - down->second->deviation[i];
  }
  return out;
}

/// A run whose reversal is that of the others with the other sign, and not a little.
void swapped(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  const Reversals all = reversals_of(passes.strokes);
  const double step = passes.step;
  for (const auto& [run, own] : all) {
    std::map<double, std::vector<double>> others;
    for (const auto& [other, by_target] : all)
      if (other != run)
        for (const auto& [target, value] : by_target) others[target].push_back(value);
    double kept = 0.0, turned = 0.0, mean = 0.0, own_mean = 0.0, scatter = 0.0, freedom = 0.0;
    double n = 0.0;
    for (const auto& [target, value] : own) {
      const auto at = others.find(target);
      if (at == others.end()) continue;
      double middle = 0.0;
      for (const double v : at->second) middle += v / static_cast<double>(at->second.size());
      for (const double v : at->second) scatter += (v - middle) * (v - middle);
      freedom += static_cast<double>(at->second.size()) - 1.0;
      kept += (value - middle) * (value - middle);
      turned += (value + middle) * (value + middle);
      mean += middle;
      own_mean += value;
      n += 1.0;
    }
    if (n < 3.0) continue;
    mean /= n;
    own_mean /= n;
    const double s = std::max(std::sqrt(freedom > 0.0 ? scatter / freedom : turned / n), step);
    // The whole run turned round agrees with the others as they agree among themselves.
    if (step <= 0.0 || kept < 25.0 * turned || turned / n > 9.0 * s * s ||
        std::fabs(mean) < 5.0 * s / std::sqrt(n))
      continue;
    out.push_back({.id = "plausibility.directions-swapped",
                   .attention = true,
                   .evidence = {{"run", static_cast<double>(run), Quantity::count},
                                {"reversal", own_mean, deviation},
                                {"others", mean, deviation}}});
    return;
  }
}

/// Standard deviation about the median without the two readings farthest off it.
double size_of(const Stroke& s) {
  std::vector<double> values = s.deviation;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double median = *middle;
  for (double& v : values) v = std::fabs(v - median);
  std::sort(values.begin(), values.end());
  values.resize(values.size() - 2);
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// A pass whose deviations are of another order of magnitude than those of the others.
void another_size(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  constexpr std::size_t fewest_readings = 6, fewest_passes = 3;
  constexpr double ratio = 8.0, chance = 1e-7;
  std::vector<std::pair<double, const Stroke*>> sizes;
  for (const Stroke& s : passes.strokes)
    if (s.deviation.size() >= fewest_readings) sizes.emplace_back(size_of(s), &s);
  if (sizes.size() < fewest_passes) return;
  std::vector<double> all;
  for (const auto& one : sizes) all.push_back(one.first);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  const double others = *middle, step = passes.step;
  if (step <= 0.0) return;
  for (const auto& [size, s] : sizes) {
    const double larger = std::max(size, others), smaller = std::min(size, others);
    if (larger < 10.0 * step || larger < ratio * smaller) continue;
    // As little scatter as that by chance: of so many readings without a curve of their own.
    const auto freedom = static_cast<double>(s->deviation.size()) - 3.0;
    if (std::pow(smaller / larger, freedom) * static_cast<double>(sizes.size()) > chance) continue;
    return out.push_back({.id = "plausibility.pass-of-another-size",
                          .attention = true,
                          .evidence = {{"size", size, deviation}, {"others", others, deviation}},
                          .texts = {{"which", name_of(*s)}}});
  }
}

}  // namespace

void implausible_passes(const Passes& passes, const Observations& o, bool with_directions,
                        std::vector<Finding>& out) {
  implausible_copies(passes, o, out);
  if (!with_directions || o.lines.size() > 1) return;
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  against_order(passes.strokes, out);
  implausible_values(passes, o, out);
  const std::size_t before = out.size();
  swapped(passes, deviation, out);
  if (out.size() == before) turned_passes(passes, o.angular, out);
  another_size(passes, deviation, out);
  if (out.size() == before && o.size() <= most_sorted) implausible_halves(passes, o.angular, out);
}

}  // namespace nonio::reading
