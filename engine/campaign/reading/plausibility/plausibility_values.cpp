// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"

namespace nonio::reading {
namespace {

double middle_value(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Mean of the other passes of a direction at the targets of one, and how these scatter about it,
/// but for a shift of each. Nothing if they have not the same targets.
struct Others {
  std::vector<double> mean;
  double count = 0.0, scatter = 0.0;
};

Others others_of(const Stroke& own, const std::vector<Stroke>& strokes) {
  Others others;
  std::vector<const Stroke*> all;
  for (const Stroke& s : strokes)
    if (&s != &own && s.line == own.line && s.direction == own.direction && s.target == own.target)
      all.push_back(&s);
  if (all.size() < 2) return others;
  others.count = static_cast<double>(all.size());
  others.mean.resize(own.target.size());
  const auto n = static_cast<double>(own.target.size());
  for (const Stroke* s : all)
    for (std::size_t i = 0; i < s->deviation.size(); ++i)
      others.mean[i] += s->deviation[i] / others.count;
  double sum = 0.0;
  for (const Stroke* s : all) {
    double shift = 0.0;
    for (std::size_t i = 0; i < s->deviation.size(); ++i)
      shift += (s->deviation[i] - others.mean[i]) / n;
    for (std::size_t i = 0; i < s->deviation.size(); ++i)
      sum += std::pow(s->deviation[i] - others.mean[i] - shift, 2);
  }
  others.scatter = std::sqrt(sum / ((others.count - 1.0) * (n - 1.0)));
  return others;
}

/// A pass that is the mean of all others of its direction in every digit: the last block of a
/// spreadsheet. Each mean is met by chance with step / (s sqrt(2 pi (1 + 1/k))).
void pass_of_means(const std::vector<Stroke>& strokes, double step, Quantity deviation,
                   std::vector<Finding>& out) {
  constexpr double chance = 1e-7;
  constexpr std::size_t fewest = 5;
  for (const Stroke& own : strokes) {
    if (own.target.size() < fewest) continue;
    const Others others = others_of(own, strokes);
    if (others.mean.empty() || others.scatter <= 0.0) continue;
    const double spread =
        others.scatter * std::sqrt(2.0 * std::numbers::pi * (1.0 + 1.0 / others.count));
    const double one = std::min(1.0, 1.02 * step / spread);
    if (std::pow(one, static_cast<double>(own.target.size())) *
            static_cast<double>(strokes.size()) >
        chance)
      continue;
    bool same = true;
    for (std::size_t i = 0; i < own.deviation.size() && same; ++i)
      same = std::fabs(own.deviation[i] - others.mean[i]) <= 0.51 * step;
    if (!same) continue;
    return out.push_back(
        {.id = "plausibility.pass-of-means",
         .attention = true,
         .evidence = {{"readings", static_cast<double>(own.target.size()), Quantity::count},
                      {"step", step, deviation},
                      {"scatter", others.scatter, deviation}},
         .texts = {{"which", name_of(own)}}});
  }
}

/// One value, at several targets, where nothing else that was read there is near it: 0 or 999 in
/// the place of what was not read.
void marks(const std::vector<Stroke>& strokes, double step, Quantity deviation,
           std::vector<Finding>& out) {
  constexpr double sigmas = 10.0, steps = 5.0, mostly = 0.8;
  constexpr std::size_t fewest = 3;
  std::map<std::tuple<std::uint32_t, int, double>, std::vector<double>> cells;
  for (const Stroke& s : strokes)
    for (std::size_t i = 0; i < s.target.size(); ++i)
      cells[{s.line, s.direction, s.target[i]}].push_back(s.deviation[i]);
  std::vector<double> apart;
  for (const auto& one : cells) {
    if (one.second.size() < fewest) continue;
    const double middle = middle_value(one.second);
    for (const double v : one.second) apart.push_back(std::fabs(v - middle));
  }
  if (apart.empty()) return;
  constexpr double of_normal = 1.4826;  // from the median of |x| to the standard deviation
  const double far = std::max(sigmas * of_normal * middle_value(apart), steps * step);
  std::map<double, std::set<double>> targets;  // by value
  std::map<double, double> outside, all;
  for (const auto& [at, values] : cells) {
    if (values.size() < fewest) continue;
    const double middle = middle_value(values);
    for (const double v : values) {
      all[v] += 1.0;
      if (std::fabs(v - middle) <= far) continue;
      targets[v].insert(std::get<2>(at));
      outside[v] += 1.0;
    }
  }
  for (const auto& [value, where] : targets) {
    if (where.size() < fewest || outside[value] < mostly * all[value]) continue;
    return out.push_back(
        {.id = "plausibility.mark-among-readings",
         .attention = true,
         .evidence = {{"value", value, deviation},
                      {"readings", outside[value], Quantity::count},
                      {"targets", static_cast<double>(where.size()), Quantity::count}}});
  }
}

/// One reading that lies 30 times farther off the others of its target (of all, where it has none)
/// than all readings range over: a table of means would carry a tenth of it to the motors.
void far_off(const Observations& o, std::vector<Finding>& out) {
  constexpr double ranges = 30.0, length = 300e-6, angle = 600.0 / arcsec_per_rad;
  constexpr std::size_t fewest_readings = 8, fewest_here = 3;
  if (o.size() < fewest_readings) return;
  std::vector<double> all = o.deviation;
  std::sort(all.begin(), all.end());
  const std::size_t tail = all.size() / 10;  // what may be misread at each end
  const double range = all[all.size() - 1 - tail] - all[tail], middle = all[all.size() / 2];
  const auto& axis = o.axes.front();
  const auto at = [&](std::size_t i) {
    return std::tuple(o.line_of(i), axis.approach.empty() ? 0 : int{axis.approach[i]},
                      std::llround(axis.position[i] / grid_tolerance));
  };
  std::map<std::tuple<std::uint32_t, int, long long>, std::vector<double>> cells;
  for (std::size_t i = 0; i < o.size(); ++i) cells[at(i)].push_back(o.deviation[i]);
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto& here = cells[at(i)];
    const double off =
        std::fabs(o.deviation[i] - (here.size() < fewest_here ? middle : middle_value(here)));
    if (off <= (o.angular ? angle : length) || off <= ranges * range) continue;
    const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
    return out.push_back(
        {.id = "plausibility.reading-far-off",
         .attention = true,
         .evidence = {{"value", o.deviation[i], deviation},
                      {"off", off, deviation},
                      {"range", range, deviation},
                      {"line", static_cast<double>(o.source_line_of(i)), Quantity::count}}});
  }
}

/// Passes that go one way but for two neighbours, where all others go one way, or turn at the same
/// two: these targets were exchanged.
void targets_against_order(const std::vector<Stroke>& strokes, Quantity position,
                           std::vector<Finding>& out) {
  constexpr std::size_t fewest_targets = 5, fewest_passes = 3;
  std::vector<const Stroke*> wrong;
  for (const Stroke& s : strokes) {
    if (!s.alone || s.target.size() < fewest_targets) return;
    if (s.sense != 0) continue;
    if (s.backwards != 1 || (!wrong.empty() && wrong.front()->turns_at != s.turns_at)) return;
    wrong.push_back(&s);
  }
  if (wrong.empty() || strokes.size() < fewest_passes) return;
  out.push_back({.id = "plausibility.targets-against-order",
                 .attention = true,
                 .evidence = {{"at", wrong.front()->turns_at, position},
                              {"passes", static_cast<double>(wrong.size()), Quantity::count},
                              {"of", static_cast<double>(strokes.size()), Quantity::count}},
                 .texts = {{"which", name_of(*wrong.front())}}});
}

}  // namespace

void implausible_values(const Passes& passes, const Observations& o, std::vector<Finding>& out) {
  const auto& [strokes, step] = passes;
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  targets_against_order(strokes, position_of(o.axes.front().rotary), out);
  if (step <= 0.0 || o.size() > most_sorted) return;
  far_off(o, out);
  marks(strokes, step, deviation, out);
  pass_of_means(strokes, step, deviation, out);
}

}  // namespace nonio::reading
