// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"

namespace nonio::reading {
namespace {

/// Finds passes that agree to the last digit. A reading agrees by chance with probability q / (s
/// sqrt(4 pi)); q: step of the digits, s: scatter of the other passes.
class Copies {
 public:
  Copies(const Passes& passes, bool angular)
      : strokes_(passes.strokes),
        least_scatter_(angular ? 0.01 * arcsec : 0.03 * um),
        step_(passes.step) {
    for (const Stroke& s : strokes_) groups_[{s.line, s.target, s.deviation}].push_back(&s);
    scatter();
  }

  void find(Quantity deviation, std::vector<Finding>& out) const {
    constexpr double chance = 1e-7;
    if (nothing_scatters()) {
      out.push_back({.id = "plausibility.no-scatter",
                     .attention = true,
                     .evidence = {{"passes", static_cast<double>(strokes_.size()), Quantity::count},
                                  {"step", step_, deviation}}});
      return;
    }
    const bool none_same = groups_.size() == strokes_.size();
    const double of_pairs = scatter_of_pairs();
    const double pair_scatter = none_same ? scatter_ : of_pairs;
    for (const auto& [what, same] : groups_) {
      if (same.size() < 2) continue;
      const auto n = static_cast<double>(std::get<2>(what).size());
      const auto [low, high] =
          std::minmax_element(std::get<2>(what).begin(), std::get<2>(what).end());
      if (*low == *high) continue;
      const double least = scatter_known_ ? least_scatter_ / 3.0 : least_scatter_;
      const double one = step_ / (std::max(pair_scatter, least) * 3.5449);
      const auto pairs = static_cast<double>(strokes_.size() * strokes_.size()) / 2.0;
      if (pairs * std::pow(std::min(one, 1.0), n) > chance) continue;
      std::string names;
      for (std::size_t i = 0; i < same.size() && i < most_named; ++i)
        names += (i == 0 ? "" : ", ") + name_of(*same[i]);
      if (same.size() > most_named) names += ", ...";
      out.push_back({.id = "plausibility.passes-identical",
                     .attention = true,
                     .evidence = {{"passes", static_cast<double>(same.size()), Quantity::count},
                                  {"readings", n, Quantity::count},
                                  {"step", step_, deviation},
                                  {"shift", 0.0, deviation}},
                     .texts = {{"which", names}}});
      return;
    }
    in_part(of_pairs, deviation, out);
  }

 private:
  static constexpr double um = 1e-6, arcsec = 1.0 / arcsec_per_rad;
  static constexpr std::size_t most_named = 6, next = 40, fewest = 4;

  /// Returns the number of readings that differ by `shift`, and the number of their different
  /// values.
  static std::pair<double, std::size_t> agreeing(const std::vector<std::pair<double, double>>& both,
                                                 double shift, double tolerance) {
    std::set<long long> values;
    double count = 0.0;
    for (const auto& [one, other] : both) {
      if (std::fabs(other - one - shift) > tolerance) continue;
      values.insert(std::llround(one / (4.0 * tolerance)));
      count += 1.0;
    }
    return {count, values.size()};
  }

  static std::vector<std::pair<double, double>> common(const Stroke& a, const Stroke& b) {
    std::vector<std::pair<double, double>> both;
    for (std::size_t i = 0, k = 0; i < a.target.size() && k < b.target.size();) {
      if (a.target[i] == b.target[k])
        both.emplace_back(a.deviation[i++], b.deviation[k++]);
      else if (a.target[i] < b.target[k])
        ++i;
      else
        ++k;
    }
    return both;
  }

  static double middle_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  /// Returns the standard deviation of a reading from differences of passes: the 40 % quantile over
  /// all pairs, which misreadings and drift do not increase; at most `scatter_`.
  double scatter_of_pairs() const {
    // Converts the median of a difference to the standard deviation of a reading.
    constexpr double sigma = 1.4826 / 1.4142;
    std::vector<double> all;
    for (std::size_t i = 0; i < strokes_.size(); ++i)
      for (std::size_t k = i + 1; k < strokes_.size() && k <= i + next; ++k) {
        if (strokes_[i].line != strokes_[k].line) continue;
        std::vector<double> apart;
        for (const auto& [a, b] : common(strokes_[i], strokes_[k])) apart.push_back(b - a);
        if (apart.size() < fewest) continue;
        const double middle = middle_of(apart);
        for (double& d : apart) d = std::fabs(d - middle);
        all.push_back(sigma * middle_of(apart));
      }
    if (all.size() < 3) return scatter_;
    const auto calm = all.begin() + static_cast<std::ptrdiff_t>(all.size() * 2 / 5);
    std::nth_element(all.begin(), calm, all.end());
    return std::min(*calm, scatter_);
  }

  /// Finds two passes in which more readings agree than chance allows, also after a common shift.
  void in_part(double of_pairs, Quantity deviation, std::vector<Finding>& out) const {
    constexpr double chance = 1e-7, most_likely = 0.3;
    if (step_ <= 0.0 || !scatter_known_) return;
    const double one = step_ / (std::max(of_pairs, least_scatter_ / 3.0) * 3.5449);
    if (one > most_likely) return;
    const double tolerance = 0.01 * step_, log_one = std::log(one);
    const auto pairs = static_cast<double>(strokes_.size() * std::min(strokes_.size(), next));
    const auto likely = [&](double n, double m) {
      return std::exp(std::lgamma(n + 1.0) - std::lgamma(m + 1.0) - std::lgamma(n - m + 1.0) +
                      m * log_one);
    };
    for (std::size_t i = 0; i < strokes_.size(); ++i)
      for (std::size_t k = i + 1; k < strokes_.size() && k <= i + next; ++k) {
        if (strokes_[i].line != strokes_[k].line) continue;
        const auto both = common(strokes_[i], strokes_[k]);
        if (both.size() < fewest) continue;
        const auto n = static_cast<double>(both.size());
        std::vector<double> apart;
        for (const auto& [a, b] : both) apart.push_back(b - a);
        for (const double shift : {0.0, middle_of(apart)}) {
          const auto [m, values] = agreeing(both, shift, tolerance);
          const bool shifted = shift != 0.0;
          if (values < 3 || m < 4.0 ||
              pairs * (shifted ? n * likely(n - 1.0, m - 1.0) : likely(n, m)) > chance)
            continue;
          out.push_back({.id = "plausibility.passes-identical",
                         .attention = true,
                         .evidence = {{"passes", 2.0, Quantity::count},
                                      {"readings", m, Quantity::count},
                                      {"step", step_, deviation},
                                      {"shift", shift, deviation}},
                         .texts = {{"which", name_of(strokes_[i]) + ", " + name_of(strokes_[k])}}});
          return;
        }
      }
  }

  /// Whether all passes are equal, although the digits are fine enough to show scatter.
  bool nothing_scatters() const {
    std::map<std::pair<std::uint32_t, int>, const Stroke*> first;
    std::size_t repeated = 0, readings = 0;
    for (const Stroke& s : strokes_) {
      const auto [at, is_new] = first.emplace(std::pair(s.line, s.direction), &s);
      if (is_new) continue;
      if (at->second->target != s.target || at->second->deviation != s.deviation) return false;
      ++repeated;
      readings += s.deviation.size();
    }
    if (repeated == 0 || step_ <= 0.0) return false;
    // Readings repeat without a copy if the digits are coarser than the scatter of the machine.
    constexpr double chance = 1e-7, least_of_range = 0.01;
    double low = 0.0, high = 0.0;
    bool any = false;
    for (const Stroke& s : strokes_)
      for (const double d : s.deviation) {
        low = any ? std::min(low, d) : d;
        high = any ? std::max(high, d) : d;
        any = true;
      }
    const double least = std::max(least_scatter_, least_of_range * (high - low));
    const double one = std::min(1.0, step_ / (least * 3.5449));
    return std::pow(one, static_cast<double>(readings)) < chance;
  }

  /// The shift of each pass is subtracted, because successive passes have a common drift.
  void scatter() {
    std::map<std::tuple<std::uint32_t, int, double>, std::pair<double, double>> cells;
    for (const auto& one : groups_) {
      const Stroke& s = *one.second.front();
      for (std::size_t i = 0; i < s.target.size(); ++i) {
        auto& cell = cells[{s.line, s.direction, s.target[i]}];
        cell.first += s.deviation[i];
        cell.second += 1.0;
      }
    }
    double sum = 0.0, freedom = 0.0;
    for (const auto& one : groups_) {
      const Stroke& s = *one.second.front();
      std::vector<double> left;
      double shift = 0.0;
      for (std::size_t i = 0; i < s.target.size(); ++i) {
        const auto& cell = cells.at({s.line, s.direction, s.target[i]});
        if (cell.second > 1.0) left.push_back(s.deviation[i] - cell.first / cell.second);
      }
      for (const double d : left) shift += d / static_cast<double>(left.size());
      for (const double d : left) sum += (d - shift) * (d - shift);
      if (left.size() > 1) freedom += static_cast<double>(left.size()) - 1.0;
    }
    scatter_known_ = freedom > 0.0;
    if (scatter_known_) scatter_ = std::sqrt(sum / freedom);
  }

  const std::vector<Stroke>& strokes_;
  double least_scatter_, step_, scatter_ = 0.0;
  bool scatter_known_ = false;
  std::map<std::tuple<std::uint32_t, std::vector<double>, std::vector<double>>,
           std::vector<const Stroke*>>
      groups_;
};

bool distinguishes(const std::vector<double>& readings, double step) {
  constexpr double chance = 1e-7;
  constexpr std::size_t fewest = 5;
  if (readings.size() < fewest || step <= 0.0) return false;
  const auto [low, high] = std::minmax_element(readings.begin(), readings.end());
  if (*high - *low < 3.0 * step) return false;
  return std::pow(step / (*high - *low), static_cast<double>(readings.size()) - 1.0) < chance;
}

using Place = std::tuple<std::uint32_t, int, double>;
using Cells = std::vector<std::pair<Place, double>>;  // sorted by place

Cells cells_by_run(const std::vector<Stroke>& strokes) {
  Cells cells;
  for (const Stroke& s : strokes)
    for (std::size_t i = 0; i < s.target.size(); ++i)
      if (i + 1 == s.target.size() || s.target[i + 1] != s.target[i])
        cells.emplace_back(Place{s.run, s.direction, s.target[i]}, s.deviation[i]);
  std::stable_sort(cells.begin(), cells.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return cells;
}

/// Returns the number of equal readings at the same run, direction and target; nullopt if they are
/// too few or chance explains them. Zeros are ignored, because instruments are set to zero at a
/// target.
std::optional<double> shared_readings(const Cells& one, const Cells& other) {
  constexpr double chance = 1e-7, of_all = 0.15;
  constexpr std::size_t fewest = 8, fewest_values = 6;
  std::map<double, double> first, second;
  std::set<double> values;
  double n = 0.0, same = 0.0, pairs = 0.0;
  auto next = other.begin();
  for (const auto& [at, value] : one) {
    while (next != other.end() && next->first < at) ++next;
    if (next == other.end()) break;
    if (next->first != at || (value == 0.0 && next->second == 0.0)) continue;
    n += 1.0;
    first[value] += 1.0;
    second[next->second] += 1.0;
    if (value != next->second) continue;
    same += 1.0;
    values.insert(value);
  }
  if (same < static_cast<double>(fewest) || values.size() < fewest_values || same < of_all * n)
    return std::nullopt;
  for (const auto& [value, count] : first)
    if (const auto there = second.find(value); there != second.end())
      pairs += count * there->second;
  // Equal pairs at the same place are left out, because they may have a common cause.
  const double likely = std::max(pairs - same, 1.0) / (n * n);
  const double p = std::exp(std::lgamma(n + 1.0) - std::lgamma(same + 1.0) -
                            std::lgamma(n - same + 1.0) + same * std::log(std::min(likely, 1.0)));
  return p < chance ? std::optional(same) : std::nullopt;
}

}  // namespace

void implausible_copies(const Passes& passes, const Observations& o, std::vector<Finding>& out) {
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  const std::size_t before = out.size();
  Copies(passes, o.angular).find(deviation, out);
  if (out.size() > before) return;
  const double step = passes.step;
  std::map<std::vector<double>, const Stroke*> seen;
  for (const Stroke& s : passes.strokes) {
    const auto [at, is_new] = seen.try_emplace(s.as_taken, &s);
    if (is_new || at->second->line == s.line || !distinguishes(s.as_taken, step)) continue;
    const auto name = [&](const Stroke& one) { return o.lines[one.line].name; };
    out.push_back(
        {.id = "plausibility.passes-identical",
         .attention = true,
         .evidence = {{"passes", 2.0, Quantity::count},
                      {"readings", static_cast<double>(s.as_taken.size()), Quantity::count},
                      {"step", step, deviation},
                      {"shift", 0.0, deviation}},
         .texts = {{"which", name(*at->second) + ", " + name(s)}}});
    return;
  }
}

std::vector<Finding> passes_of_another_measurement(const Campaign& campaign,
                                                   const std::vector<Observations>& all,
                                                   const std::vector<Passes>& passes) {
  std::vector<Finding> out;
  std::map<std::vector<double>, std::size_t> seen;
  std::vector<Cells> cells(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].size() == 0 || all[i].axes.empty()) continue;
    const auto& [strokes, step] = passes[i];
    if (all.size() > 1 && all[i].axes.size() == 1 && all[i].lines.size() == 1)
      cells[i] = cells_by_run(strokes);
    std::map<std::size_t, double> shared;
    for (const Stroke& s : strokes) {
      const auto [at, is_new] = seen.try_emplace(s.as_taken, i);
      if (!is_new && at->second != i && distinguishes(s.as_taken, step)) shared[at->second] += 1.0;
    }
    for (std::size_t other = 0; other < i && shared.empty() && !cells[i].empty(); ++other) {
      const auto readings = shared_readings(cells[i], cells[other]);
      if (!readings) continue;
      const Measurement &m = campaign.measurements[i], &first = campaign.measurements[other];
      out.push_back({.id = "plausibility.stretch-twice",
                     .attention = true,
                     .evidence = {{"readings", *readings, Quantity::count},
                                  {"of", static_cast<double>(all[i].size()), Quantity::count}},
                     .texts = {{"file", m.file}, {"other", first.file}, {"with", first.id}},
                     .measurement = m.id});
      break;
    }
    for (const auto& [other, count] : shared) {
      const Measurement &m = campaign.measurements[i], &first = campaign.measurements[other];
      out.push_back({.id = "plausibility.readings-twice",
                     .attention = true,
                     .evidence = {{"passes", count, Quantity::count},
                                  {"of", static_cast<double>(strokes.size()), Quantity::count}},
                     .texts = {{"file", m.file}, {"other", first.file}, {"with", first.id}},
                     .measurement = m.id});
    }
  }
  return out;
}

}  // namespace nonio::reading
