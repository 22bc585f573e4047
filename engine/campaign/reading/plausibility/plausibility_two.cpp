// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading {
namespace {

struct Grid {
  std::vector<std::uint32_t> runs;        ///< in the order of measurement
  std::vector<double> targets;            ///< ascending, m or rad
  std::vector<std::vector<double>> mean;  ///< mean of both directions, [run][target]
  /// [run][target]; empty with one direction
  std::vector<std::vector<double>> reversal;
};

/// Returns the last reading at each target. All targets must occur.
std::vector<double> values_at(const Stroke& s, const std::vector<double>& targets) {
  std::vector<double> out;
  out.reserve(targets.size());
  std::size_t next = 0;
  for (const double target : targets) {
    while (next + 1 < s.target.size() && s.target[next] < target) ++next;
    while (next + 1 < s.target.size() && s.target[next + 1] == target) ++next;
    out.push_back(s.deviation[next]);
  }
  return out;
}

Grid grid_of(const std::vector<Stroke>& strokes) {
  Grid grid;
  std::map<std::uint32_t, std::size_t> place;
  std::map<double, std::size_t> passes_with;
  std::set<int> directions;
  for (const Stroke& s : strokes) {
    if (place.try_emplace(s.run, place.size()).second) grid.runs.push_back(s.run);
    directions.insert(s.direction);
    for (std::size_t i = 0; i < s.target.size(); ++i)
      if (i == 0 || s.target[i] != s.target[i - 1]) ++passes_with[s.target[i]];
  }
  for (const auto& [target, passes] : passes_with)
    if (passes == grid.runs.size() * directions.size()) grid.targets.push_back(target);
  if (grid.targets.empty()) return grid;
  std::vector<std::vector<double>> first(grid.runs.size()), last(grid.runs.size());
  for (const Stroke& s : strokes) {
    const auto values = values_at(s, grid.targets);
    if (s.direction == *directions.begin()) first[place[s.run]] = values;
    if (s.direction == *directions.rbegin()) last[place[s.run]] = values;
  }
  for (std::size_t r = 0; r < grid.runs.size(); ++r) {
    auto& mean = grid.mean.emplace_back(std::move(first[r]));
    if (directions.size() == 2) grid.reversal.push_back(last[r]);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      if (directions.size() == 2) grid.reversal.back()[i] -= mean[i];
      mean[i] = (mean[i] + last[r][i]) / 2.0;
    }
  }
  return grid;
}

double square_mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

struct Group {
  std::vector<double> mean;
  double squares = 0.0, freedom = 0.0;

  Group(const std::vector<std::vector<double>>& curves, std::size_t from, std::size_t to)
      : mean(curves.front().size()) {
    const auto n = static_cast<double>(to - from);
    for (std::size_t r = from; r < to; ++r)
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += curves[r][i] / n;
    for (std::size_t r = from; r < to; ++r)
      for (std::size_t i = 0; i < mean.size(); ++i)
        squares += (curves[r][i] - mean[i]) * (curves[r][i] - mean[i]);
    // Without the line of each run, which reduces the degrees of freedom by two.
    freedom = (n - 1.0) * (static_cast<double>(mean.size()) - 2.0);
  }
};

/// Factor for limits of running sums, whose errors reach 1e-6. Findings are computed directly.
constexpr double nearly = 1.0 - 1e-6;

/// Returns the sum of squares of the first k curves about their mean, for k = 0, 1, 2, ...
template <class Iterator>
std::vector<double> growing_squares(Iterator from, Iterator to) {
  std::vector<double> out{0.0};
  std::vector<RunningMean> means(from->size());
  for (; from != to; ++from) {
    double sum = 0.0;
    for (std::size_t i = 0; i < means.size(); ++i)
      means[i].add((*from)[i]), sum += means[i].squares;
    out.push_back(sum);
  }
  return out;
}

class Parted {
 public:
  explicit Parted(const std::vector<std::vector<double>>& curves)
      : before_(growing_squares(curves.begin(), curves.end())),
        behind_(growing_squares(curves.rbegin(), curves.rend())),
        first_(curves.front().size()),
        all_(curves.front().size()) {
    for (const auto& curve : curves) add(curve, all_);
  }

  /// Must be called for k = 1, 2, ... with curves[k - 1].
  void take(const std::vector<double>& curve) { add(curve, first_), ++taken_; }

  /// `skipped`: curves that belong to neither group.
  bool may_be_two(std::span<const std::vector<double>> skipped, double least_scatter,
                  double squares, double of_curve) const {
    const std::size_t behind = before_.size() - 1 - taken_ - skipped.size();
    const auto n = static_cast<double>(taken_), m = static_cast<double>(behind);
    const double freedom = (n + m - 2.0) * (static_cast<double>(first_.size()) - 2.0);
    const double scatter = std::max((before_[taken_] + behind_[behind]) / freedom, least_scatter);
    double apart = 0.0, of_first = 0.0, of_rest = 0.0;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      double rest = all_[i] - first_[i];
      for (const auto& curve : skipped) rest -= curve[i];
      const double a = first_[i] / n, b = rest / m;
      apart += (a - b) * (a - b), of_first += a * a, of_rest += b * b;
    }
    const auto targets = static_cast<double>(first_.size());
    return apart / targets >= nearly * squares * scatter &&
           apart >= nearly * of_curve * std::max(of_first, of_rest);
  }

 private:
  static void add(const std::vector<double>& curve, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += curve[i];
  }

  std::vector<double> before_, behind_, first_, all_;
  std::size_t taken_ = 0;
};

/// Reports the first run from which on the curve, without its line, differs. The runs of each group
/// must agree with each other. A gradual change is not reported: with even steps, the squared
/// distance of the groups is at most 18 times the variance in them, less than `squares`.
void two_curves(const Grid& grid, double step, Quantity deviation, std::vector<Finding>& out) {
  constexpr std::size_t fewest_targets = 6, fewest_runs = 4;
  constexpr double squares = 25.0, of_curve = 0.1;
  if (grid.targets.size() < fewest_targets || grid.runs.size() < fewest_runs) return;
  std::vector<std::vector<double>> curves = grid.mean;
  for (auto& curve : curves) take_line_out(grid.targets, curve);
  const std::size_t n = curves.size();
  // A run whose rows are from both curves belongs to neither group.
  for (const std::size_t gap : {0U, 1U}) {
    Parted parted(curves);
    parted.take(curves.front());
    for (std::size_t k = 2; k + gap + 2 <= n; ++k) {
      parted.take(curves[k - 1]);
      if (!parted.may_be_two(std::span(curves).subspan(k, gap), step * step / 4.0, squares,
                             of_curve))
        continue;
      const Group first(curves, 0, k), rest(curves, k + gap, n);
      const double scatter = std::max(
          (first.squares + rest.squares) / (first.freedom + rest.freedom), step * step / 4.0);
      std::vector<double> apart = first.mean;
      for (std::size_t i = 0; i < apart.size(); ++i) apart[i] -= rest.mean[i];
      const double size = std::max(square_mean(first.mean), square_mean(rest.mean));
      const double d = square_mean(apart);
      if (d < squares * scatter || d < of_curve * size) continue;
      return out.push_back({.id = "plausibility.two-curves",
                            .attention = true,
                            .evidence = {{"apart", std::sqrt(d), deviation},
                                         {"scatter", std::sqrt(scatter), deviation}},
                            .texts = {{"which", std::to_string(grid.runs[k + gap])}}});
    }
  }
}

double about_mean(const std::vector<double>& values, std::size_t from, std::size_t to) {
  double mean = 0.0, sum = 0.0;
  for (std::size_t i = from; i < to; ++i) mean += values[i] / static_cast<double>(to - from);
  for (std::size_t i = from; i < to; ++i) sum += (values[i] - mean) * (values[i] - mean);
  return sum;
}

double mean_of(const std::vector<double>& values, std::size_t from, std::size_t to) {
  double mean = 0.0;
  for (std::size_t i = from; i < to; ++i) mean += values[i] / static_cast<double>(to - from);
  return mean;
}

double jump(const Grid& grid, const std::vector<double>& curve, std::size_t at) {
  const auto slope = [&](std::size_t i) {
    return (curve[i] - curve[i - 1]) / (grid.targets[i] - grid.targets[i - 1]);
  };
  const double around = (slope(at - 1) + slope(at + 1)) / 2.0;
  return std::fabs(curve[at] - curve[at - 1] - around * (grid.targets[at] - grid.targets[at - 1]));
}

template <class Iterator>
std::vector<double> largest_so_far(Iterator from, Iterator to) {
  std::vector<double> out;
  for (; from != to; ++from) out.push_back(out.empty() ? *from : std::max(out.back(), *from));
  return out;
}

/// Reports a target from which on the reversal has another constant value, with the largest jump of
/// the curve.
void two_reversals(const Grid& grid, double step, Quantity deviation, std::vector<Finding>& out) {
  constexpr std::size_t fewest_side = 3, fewest_targets = 8, fewest_runs = 3;
  constexpr double sigmas = 8.0, of_reversal = 0.15, jumps = 2.5, line = 3.0;
  const std::size_t n = grid.targets.size(), runs = grid.runs.size();
  if (grid.reversal.empty() || n < fewest_targets || runs < fewest_runs) return;
  std::vector<double> reversal(n), curve(n);
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t r = 0; r < runs; ++r) {
      reversal[i] += grid.reversal[r][i] / static_cast<double>(runs);
      curve[i] += grid.mean[r][i] / static_cast<double>(runs);
    }
    for (std::size_t r = 0; r < runs; ++r)
      squares += (grid.reversal[r][i] - reversal[i]) * (grid.reversal[r][i] - reversal[i]);
  }
  const double of_mean =
      std::max(squares / static_cast<double>(n * (runs - 1)), step * step / 4.0) /
      static_cast<double>(runs);
  std::vector<double> straight = reversal, jumping(n);
  take_line_out(grid.targets, straight);
  for (std::size_t i = 2; i + 1 < n; ++i) jumping[i] = jump(grid, curve, i);
  const auto up_to = largest_so_far(jumping.begin(), jumping.end());
  const auto from_end = largest_so_far(jumping.rbegin(), jumping.rend());
  for (std::size_t at = fewest_side; at + fewest_side <= n; ++at) {
    // This test excludes nearly all targets without a sum over the others.
    const double elsewhere = std::max(up_to[at - 2], from_end[n - at - 3]);
    if (jumping[at] < jumps * elsewhere) continue;
    const double before = mean_of(reversal, 0, at), behind = mean_of(reversal, at, n);
    const double rest = about_mean(reversal, 0, at) + about_mean(reversal, at, n);
    const auto left = static_cast<double>(at), right = static_cast<double>(n - at);
    const double sigma = std::sqrt(of_mean * (1.0 / left + 1.0 / right));
    const double change = std::fabs(before - behind);
    const double largest = std::max(std::fabs(before), std::fabs(behind));
    if (change < sigmas * sigma || change < of_reversal * largest ||
        rest > 2.5 * of_mean * (static_cast<double>(n) - 2.0) ||
        square_mean(straight) * static_cast<double>(n) < line * rest)
      continue;
    const Quantity position =
        deviation == Quantity::angular_deviation ? Quantity::angle : Quantity::length;
    return out.push_back({.id = "plausibility.two-reversals",
                          .attention = true,
                          .evidence = {{"from", grid.targets[at], position},
                                       {"before", before, deviation},
                                       {"behind", behind, deviation},
                                       {"jump", jumping[at], deviation}}});
  }
}

}  // namespace

void implausible_halves(const Passes& passes, bool angular, std::vector<Finding>& out) {
  const auto& [strokes, step] = passes;
  if (strokes.empty()) return;
  const Quantity deviation = angular ? Quantity::angular_deviation : Quantity::deviation;
  const Grid grid = grid_of(strokes);
  if (grid.targets.empty() || step <= 0.0) return;
  const std::size_t before = out.size();
  two_curves(grid, step, deviation, out);
  if (out.size() == before) two_reversals(grid, step, deviation, out);
}

}  // namespace nonio::reading
