// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading {
namespace {

/// Rising targets contradict direction -, falling targets direction +. No finding if all strokes
/// have the same order or all targets were approached from one side.
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

struct Reversals {
  std::uint32_t run = 0;
  std::vector<double> target, value;
};

/// The strokes must be sorted by target. The last of repeated readings is used.
Reversals reversals_between(const Stroke& up, const Stroke& down) {
  Reversals out{up.run, {}, {}};
  const auto is_last = [](const Stroke& s, std::size_t i) {
    return i + 1 == s.target.size() || s.target[i + 1] != s.target[i];
  };
  for (std::size_t i = 0, k = 0; i < up.target.size() && k < down.target.size();) {
    if (!is_last(up, i) || up.target[i] < down.target[k]) {
      ++i;
    } else if (!is_last(down, k) || down.target[k] < up.target[i]) {
      ++k;
    } else {
      out.target.push_back(up.target[i]);
      out.value.push_back(up.deviation[i++] - down.deviation[k++]);
    }
  }
  return out;
}

std::vector<Reversals> reversals_of(const std::vector<Stroke>& strokes) {
  std::map<std::uint32_t, const Stroke*> plus, minus;
  for (const Stroke& s : strokes) (s.direction > 0 ? plus : minus)[s.run] = &s;
  std::vector<Reversals> out;
  for (const auto& [run, up] : plus)
    if (const auto down = minus.find(run); down != minus.end())
      out.push_back(reversals_between(*up, *down->second));
  return out;
}

/// Reports a run with a large reversal whose sign differs from that of the other runs.
void swapped(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  const auto all = reversals_of(passes.strokes);
  const double step = passes.step;
  std::map<double, RunningMean> means;
  for (const Reversals& own : all)
    for (std::size_t i = 0; i < own.target.size(); ++i) means[own.target[i]].add(own.value[i]);
  for (const Reversals& own : all) {
    double kept = 0.0, turned = 0.0, mean = 0.0, own_mean = 0.0, scatter = 0.0, freedom = 0.0;
    double n = 0.0;
    for (std::size_t i = 0; i < own.target.size(); ++i) {
      const double value = own.value[i];
      const RunningMean others = means.at(own.target[i]).without(value);
      if (others.count < 1.0) continue;
      scatter += others.squares;
      freedom += others.count - 1.0;
      kept += (value - others.mean) * (value - others.mean);
      turned += (value + others.mean) * (value + others.mean);
      mean += others.mean;
      own_mean += value;
      n += 1.0;
    }
    if (n < 3.0) continue;
    mean /= n;
    own_mean /= n;
    const double s = std::max(std::sqrt(freedom > 0.0 ? scatter / freedom : turned / n), step);
    if (step <= 0.0 || kept < 25.0 * turned || turned / n > 9.0 * s * s ||
        std::fabs(mean) < 5.0 * s / std::sqrt(n))
      continue;
    out.push_back({.id = "plausibility.directions-swapped",
                   .attention = true,
                   .evidence = {{"run", static_cast<double>(own.run), Quantity::count},
                                {"reversal", own_mean, deviation},
                                {"others", mean, deviation}}});
    return;
  }
}

/// Standard deviation about the median, without the two readings farthest from the median.
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

/// Reports a pass whose deviations differ from those of the others by an order of magnitude.
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
    // Probability that so many readings scatter so little by chance.
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
  // A circle has both directions of each axis in one pass.
  if (!with_directions || o.lines.size() > 1 || !o.sense.empty()) return;
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  against_order(passes.strokes, out);
  implausible_values(passes, o, out);
  const std::size_t before = out.size();
  swapped(passes, deviation, out);
  if (out.size() == before) turned_passes(passes, o.angular, out);
  another_size(passes, deviation, out);
  if (out.size() == before) implausible_halves(passes, o.angular, out);
}

}  // namespace nonio::reading
