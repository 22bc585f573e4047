// SPDX-License-Identifier: Apache-2.0
#include "scatter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "data/whitening.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::model {

namespace {

/// Returns the residuals minus the offset, slope and curvature of each pass.
std::vector<double> within_passes(const Repeats& repeats, const std::vector<double>& residual,
                                  const std::vector<double>& weight) {
  // one cell per pass, because with one cell per reading no residual would remain
  Repeats alone = repeats;
  alone.cell = alone.pass;
  alone.cells = alone.passes;
  return saturate(alone, residual, weight).e;
}

struct Sides {
  std::size_t low = 0, high = 0;
  void add(bool is_low) { ++(is_low ? low : high); }
  std::size_t all() const { return low + high; }
  bool mixed() const { return low > 0 && high > 0; }
};

/// Whether repeats of a cell are on different sides more often than independent states allow, and
/// the sides do not follow the passes, as in synthetic readings of two runs with a given standard
/// deviation. `low`: share of readings below the split.
bool are_opposite(const std::vector<Sides>& of_cell, const std::vector<Sides>& of_pass,
                  double low) {
  // docs/dev/constants.md, M44.
  constexpr double far = 4.0, of_one_pass = 0.75;
  double excess = 0.0, variance = 0.0, n = 0.0, as_pass = 0.0;
  for (const Sides& c : of_cell) {
    if (c.all() < 2) continue;
    const auto k = static_cast<double>(c.all());
    const double likely = 1.0 - std::pow(low, k) - std::pow(1.0 - low, k);
    excess += (c.mixed() ? 1.0 : 0.0) - likely;
    variance += likely * (1.0 - likely);
  }
  for (const Sides& p : of_pass)
    n += static_cast<double>(p.all()), as_pass += static_cast<double>(std::max(p.low, p.high));
  return excess > far * std::sqrt(variance) && as_pass < of_one_pass * n;
}

}  // namespace

bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight, double digit) {
  std::vector<std::pair<double, std::uint32_t>> e;  // residual and row
  for (std::uint32_t i = 0; i < weight.size(); ++i)
    if (weight[i] > 0.0) e.emplace_back(residual[i], i);
  if (e.size() < 40) return false;
  std::sort(e.begin(), e.end());
  const auto n = static_cast<double>(e.size());
  double sum = 0.0, squares = 0.0;
  for (const auto& [x, row] : e) sum += x, squares += x * x;
  double left = 0.0, best = 0.0, best_apart = 0.0;
  std::size_t split = 0;
  for (std::size_t i = 0; i + 1 < e.size(); ++i) {
    left += e[i].first;
    const double k = static_cast<double>(i + 1);
    if (k < 0.1 * n || k > 0.9 * n) continue;
    const double apart = left / k - (sum - left) / (n - k);
    const double between = apart * apart * k * (n - k) / n;
    const double within = (squares - sum * sum / n - between) / n;
    // the largest value of this ratio is about 7 for normal noise, and 12 for uniform noise
    if (apart * apart / within > best)
      best = apart * apart / within, best_apart = -apart, split = i + 1;
  }
  // docs/dev/constants.md, M33.
  constexpr double one_digit = 1.6;  // two adjacent digits of a coarse display
  if (best < 18.0 || best_apart < one_digit * digit) return false;
  std::vector<Sides> of_cell(repeats.cells), of_pass(repeats.passes);
  for (std::size_t i = 0; i < e.size(); ++i) {
    of_cell[repeats.cell[e[i].second]].add(i < split);
    of_pass[repeats.pass[e[i].second]].add(i < split);
  }
  const auto mixed =
      std::count_if(of_cell.begin(), of_cell.end(), [](const Sides& c) { return c.mixed(); });
  return static_cast<double>(mixed) > 0.25 * static_cast<double>(repeats.cells) &&
         !are_opposite(of_cell, of_pass, static_cast<double>(split) / n);
}

namespace {

/// In cells that only one run has read, the scatter of a run is not known.
std::vector<char> in_repeated_cells(const Observations& o, const Repeats& repeats) {
  std::vector<std::uint32_t> first(repeats.cells, 0);
  std::vector<char> several(repeats.cells, 0), out(o.size(), 0);
  for (std::size_t i = 0; i < o.size() && !o.run.empty(); ++i) {
    std::uint32_t& run = first[repeats.cell[i]];
    if (run == 0) run = o.run_of(i);
    if (run != o.run_of(i)) several[repeats.cell[i]] = 1;
  }
  for (std::size_t i = 0; i < o.size(); ++i) out[i] = several[repeats.cell[i]];
  return out;
}

}  // namespace

std::optional<Place> next_to_a_misread_target(const Observations& o, const Repeats& repeats,
                                              const std::vector<double>& residual,
                                              const std::vector<double>& weight) {
  constexpr std::size_t fewest = 5;
  const std::size_t n = residual.size(), m = repeats.targets;
  if (o.axes.size() > 1 || m < fewest || n != 2 * m || repeats.cells != n || repeats.sides != 2)
    return std::nullopt;
  std::vector<double> middle(m, 0.0), difference(m, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(weight[i] > 0.0)) return std::nullopt;
    const double way = repeats.side[repeats.pass[i]] == 0 ? 1.0 : -1.0;
    middle[repeats.target[i]] += residual[i] / 2.0;
    difference[repeats.target[i]] += way * residual[i];
  }
  // Returns the sum of squares about their mean, without one target.
  const auto squares_without = [m](const std::vector<double>& x, std::size_t out) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t t = 0; t < m; ++t) sum += t == out ? 0.0 : x[t];
    const double mean = sum / static_cast<double>(m - 1);
    for (std::size_t t = 0; t < m; ++t) squares += t == out ? 0.0 : (x[t] - mean) * (x[t] - mean);
    return squares;
  };
  std::optional<Place> best;
  const auto dof = static_cast<double>(m - 2);
  for (std::size_t t = 0; t < m; ++t) {
    // Scaled to one reading: a mean of two has half its variance, a difference twice.
    const double between = 2.0 * squares_without(middle, t) / dof;
    const double within = squares_without(difference, t) / 2.0 / dof;
    const double p = std::min(
        math::f_upper(math::test_ratio(between, within), dof, dof) * static_cast<double>(m), 1.0);
    if (!best || p < best->p)
      best = Place{{Factor::position},
                   between / (between + within),
                   p,
                   std::sqrt(std::max(between - within, 0.0) / 2.0)};
  }
  return best;
}

std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight, const Noise& noise) {
  const double display = noise.digit * noise.digit / 12.0;
  std::vector<std::vector<double>> of_run;
  const std::vector<char> repeated = in_repeated_cells(o, repeats);
  std::vector<double> of_repeats = weight;
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (repeated[i] == 0) of_repeats[i] = 0.0;
  // Use repeated readings only: a model's errors at targets of a single run are not scatter.
  const bool some = std::find(repeated.begin(), repeated.end(), 0) != repeated.end();
  const std::vector<double> e_of = some ? saturate(repeats, o.deviation, of_repeats).e
                                        : within_passes(repeats, residual, weight);
  for (std::size_t i = 0; i < o.size(); ++i) {
    const std::size_t run = o.run.empty() ? 0 : o.run[i];
    if (run >= of_run.size()) of_run.resize(run + 1);
    if (repeated[i] != 0)
      of_run[run].push_back(noise.rough.empty() ? e_of[i] : e_of[i] / noise.rough[i]);
  }
  double all = 0.0, n = 0.0, runs = 0.0;
  for (const auto& e : of_run) {
    for (const double x : e) all += x * x, ++n;
    runs += e.empty() ? 0.0 : 1.0;
  }
  std::optional<Place> worst;
  for (std::size_t run = 0; run < of_run.size(); ++run) {
    const auto k = static_cast<double>(of_run[run].size());
    if (k < 6.0 || n - k < 6.0) continue;
    // Use the median, so that one outlier does not make a run significant.
    std::vector<double> size;
    double squares = 0.0;
    for (const double x : of_run[run]) size.push_back(std::fabs(x)), squares += x * x;
    const double s = 1.4826 * math::median(size);
    std::vector<double> others;
    for (std::size_t r = 0; r < of_run.size(); ++r)
      if (r != run)
        for (const double x : of_run[r]) others.push_back(std::fabs(x));
    const double s_others = 1.4826 * math::median(others);
    const double F = math::test_ratio(s * s, std::max(s_others * s_others, display));
    // A scatter from the median has the precision of one from 0.37 times as many squares.
    double p = math::f_upper(F, 0.37 * k, 0.37 * (n - k)) * runs;
    // Residuals of short passes depend on each other, so that medians alone differ by chance. Half
    // of the squares are independent; outliers of the other runs are reduced to 3.5 deviations.
    double of_others = 0.0;
    for (const double x : others) of_others += std::pow(std::min(x, 3.5 * s_others), 2);
    p = std::max(
        p, math::f_upper(math::test_ratio(squares / k, std::max(of_others / (n - k), display)),
                         0.5 * k, 0.5 * (n - k)) *
               runs);
    if (F < 4.0 || p > 1e-4 || (worst && p >= worst->p)) continue;
    worst = Place{{Factor::run}, squares / all, p, s, static_cast<double>(run), Quantity::count};
  }
  return worst;
}

double degrees_of_cells(const Repeats& repeats, const std::vector<double>& weight) {
  std::vector<Index> in_pass(repeats.passes, 0), shared(repeats.sides, 0);
  std::vector<char> used(repeats.cells, 0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (weight[i] > 0.0) ++in_pass[repeats.pass[i]], used[repeats.cell[i]] = 1;
  for (std::size_t p = 0; p < in_pass.size(); ++p) {
    Index& of_side = shared[repeats.side[p]];
    of_side = std::max(of_side, shared_columns(in_pass[p]));
  }
  return static_cast<double>(std::count(used.begin(), used.end(), 1) -
                             std::accumulate(shared.begin(), shared.end(), Index{0}));
}

}  // namespace nonio::model
