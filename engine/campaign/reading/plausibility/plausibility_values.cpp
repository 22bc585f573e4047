// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading {
namespace {

double middle_value(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Mean of the other passes, and scatter without the shift of each pass. `mean` is empty if fewer
/// than two passes have the same targets.
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

/// Computes mean and scatter of all passes but one approximately from sums.
class Alike {
 public:
  void add(const Stroke& s) {
    if (mean_.empty()) mean_.resize(s.target.size());
    for (std::size_t i = 0; i < mean_.size(); ++i) mean_[i].add(s.deviation[i]);
  }

  void add_scatter(const Stroke& s) { squares_ += squares_of(s); }

  bool may_be_mean(const Stroke& own, double tolerance) const {
    if (count() < 3.0) return false;
    for (std::size_t i = 0; i < mean_.size(); ++i)
      if (std::fabs(own.deviation[i] - mean_[i].mean) * count() / (count() - 1.0) > tolerance)
        return false;
    return true;
  }

  double scatter_without(const Stroke& own) const {
    const double others = count() - 1.0, free = static_cast<double>(mean_.size()) - 1.0;
    const double squares = squares_ - squares_of(own) * (1.0 + 1.0 / others);
    return std::sqrt(std::max(0.0, squares) / ((others - 1.0) * free));
  }

  double count() const { return mean_.front().count; }

 private:
  double squares_of(const Stroke& s) const {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      const double off = s.deviation[i] - mean_[i].mean;
      sum += off, squares += off * off;
    }
    return squares - sum * sum / static_cast<double>(mean_.size());
  }

  std::vector<RunningMean> mean_;
  double squares_ = 0.0;
};

using ByTargets = std::map<std::tuple<std::uint32_t, int, std::vector<double>>, Alike>;

ByTargets alike_of(const std::vector<Stroke>& strokes) {
  ByTargets alike;
  for (const Stroke& s : strokes) alike[{s.line, s.direction, s.target}].add(s);
  for (const Stroke& s : strokes) alike[{s.line, s.direction, s.target}].add_scatter(s);
  return alike;
}

/// Reports a pass that equals the mean of all others of its direction in every digit. By chance, a
/// reading does so with probability step / (s sqrt(2 pi (1 + 1/k))); s: scatter of the k others.
void pass_of_means(const std::vector<Stroke>& strokes, double step, Quantity deviation,
                   std::vector<Finding>& out) {
  constexpr double chance = 1e-7, at_most = 1.0 + 1e-6;
  constexpr std::size_t fewest = 5;
  const ByTargets alike = alike_of(strokes);
  const auto by_chance = [&](double scatter, double others, std::size_t readings) {
    const double spread = scatter * std::sqrt(2.0 * std::numbers::pi * (1.0 + 1.0 / others));
    const double one = std::min(1.0, 1.02 * step / spread);
    return std::pow(one, static_cast<double>(readings)) * static_cast<double>(strokes.size());
  };
  for (const Stroke& own : strokes) {
    const std::size_t n = own.target.size();
    if (n < fewest) continue;
    const Alike& all = alike.at({own.line, own.direction, own.target});
    if (!all.may_be_mean(own, at_most * 0.51 * step) ||
        by_chance(at_most * all.scatter_without(own), all.count() - 1.0, n) > chance)
      continue;
    const Others others = others_of(own, strokes);
    if (others.mean.empty() || others.scatter <= 0.0) continue;
    if (by_chance(others.scatter, others.count, n) > chance) continue;
    bool same = true;
    for (std::size_t i = 0; i < own.deviation.size() && same; ++i)
      same = std::fabs(own.deviation[i] - others.mean[i]) <= 0.51 * step;
    if (!same) continue;
    return out.push_back({.id = "plausibility.pass-of-means",
                          .attention = true,
                          .evidence = {{"readings", static_cast<double>(n), Quantity::count},
                                       {"step", step, deviation},
                                       {"scatter", others.scatter, deviation}},
                          .texts = {{"which", name_of(own)}}});
  }
}

/// Reports a value at several targets that differs from their other readings, such as 999 for a
/// missing reading.
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
  constexpr double of_normal = 1.4826;  // factor from the median of |x| to the standard deviation
  const double far = std::max(sigmas * of_normal * middle_value(apart), steps * step);
  std::map<double, std::set<double>> targets;
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

/// Reports a reading that differs from the median of its target (of all readings, if the target has
/// fewer than three) by more than 0.3 mm or 600 arcsec and 30 times the range of the readings
/// without a tenth at each end. A table of means would contain a tenth of this error or more.
void far_off(const Observations& o, std::vector<Finding>& out) {
  constexpr double ranges = 30.0, length = 300e-6, angle = 600.0 / arcsec_per_rad;
  constexpr std::size_t fewest_readings = 8, fewest_here = 3;
  if (o.size() < fewest_readings) return;
  std::vector<double> all = o.deviation;
  std::sort(all.begin(), all.end());
  // Readings at each end that may be misreadings.
  const std::size_t tail = all.size() / 10;
  const double range = all[all.size() - 1 - tail] - all[tail], middle = all[all.size() / 2];
  const auto& axis = o.axes.front();
  const auto at = [&](std::size_t i) {
    return std::tuple(o.line_of(i), axis.approach.empty() ? 0 : int{axis.approach[i]},
                      std::llround(axis.position[i] / grid_tolerance));
  };
  std::map<std::tuple<std::uint32_t, int, long long>, std::vector<double>> cells;
  for (std::size_t i = 0; i < o.size(); ++i) cells[at(i)].push_back(o.deviation[i]);
  std::map<std::tuple<std::uint32_t, int, long long>, double> middles;
  for (auto& [where, here] : cells)
    middles[where] = here.size() < fewest_here ? middle : middle_value(std::move(here));
  for (std::size_t i = 0; i < o.size(); ++i) {
    const double off = std::fabs(o.deviation[i] - middles[at(i)]);
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

/// Reports passes in which one pair of adjacent targets, the same in each, contradicts the
/// direction.
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
  if (step <= 0.0) return;
  far_off(o, out);
  marks(strokes, step, deviation, out);
  pass_of_means(strokes, step, deviation, out);
}

}  // namespace nonio::reading
