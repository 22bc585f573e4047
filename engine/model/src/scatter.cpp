// SPDX-License-Identifier: Apache-2.0
#include "scatter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::model {

namespace {

constexpr double memory_p = 1e-4;  // noise without a memory looks so once in 10,000

/// Residuals without what a whole pass shares.
std::vector<double> within_passes(const Repeats& repeats, const std::vector<double>& residual,
                                  const std::vector<double>& weight) {
  Repeats alone = repeats;  // every reading a cell of its own would leave nothing: one cell a pass
  alone.cell = alone.pass;
  alone.cells = alone.passes;
  return saturate(alone, residual, weight).e;
}

}  // namespace

bool two_valued(const Repeats& repeats, const std::vector<double>& residual,
                const std::vector<double>& weight) {
  std::vector<std::pair<double, std::uint32_t>> e;  // residual and cell
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (weight[i] > 0.0) e.emplace_back(residual[i], repeats.cell[i]);
  if (e.size() < 40) return false;
  std::sort(e.begin(), e.end());
  const auto n = static_cast<double>(e.size());
  double sum = 0.0, squares = 0.0;
  for (const auto& [x, cell] : e) sum += x, squares += x * x;
  double left = 0.0, best = 0.0;
  std::size_t split = 0;
  for (std::size_t i = 0; i + 1 < e.size(); ++i) {
    left += e[i].first;
    const double k = static_cast<double>(i + 1);
    if (k < 0.1 * n || k > 0.9 * n) continue;
    const double apart = left / k - (sum - left) / (n - k);
    const double between = apart * apart * k * (n - k) / n;
    const double within = (squares - sum * sum / n - between) / n;
    // Of normal noise 7, of evenly spread noise 12.
    if (apart * apart / within > best) best = apart * apart / within, split = i + 1;
  }
  if (best < 18.0) return false;
  std::vector<int> side(repeats.cells, 0);
  for (std::size_t i = 0; i < e.size(); ++i) side[e[i].second] |= i < split ? 1 : 2;
  const auto mixed = std::count(side.begin(), side.end(), 3);
  return static_cast<double>(mixed) > 0.25 * static_cast<double>(repeats.cells);
}

std::optional<Place> wild_run(const Observations& o, const Repeats& repeats,
                              const std::vector<double>& residual,
                              const std::vector<double>& weight) {
  std::vector<std::vector<double>> of_run;
  const std::vector<double> e_of = within_passes(repeats, residual, weight);
  for (std::size_t i = 0; i < o.size(); ++i) {
    const std::size_t run = o.run.empty() ? 0 : o.run[i];
    if (run >= of_run.size()) of_run.resize(run + 1);
    of_run[run].push_back(e_of[i]);
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
    // By its median, so that one misread value makes no wild run.
    std::vector<double> size;
    double squares = 0.0;
    for (const double x : of_run[run]) size.push_back(std::fabs(x)), squares += x * x;
    const double s = 1.4826 * math::median(size);
    std::vector<double> others;
    for (std::size_t r = 0; r < of_run.size(); ++r)
      if (r != run)
        for (const double x : of_run[r]) others.push_back(std::fabs(x));
    const double s_others = 1.4826 * math::median(others);
    const double F = s * s / (s_others * s_others);
    // A median knows a scatter as well as 0.37 times as many squares do.
    const double p = math::f_upper(F, 0.37 * k, 0.37 * (n - k)) * runs;
    if (F < 4.0 || p > 1e-4 || (worst && p >= worst->p)) continue;
    worst = Place{"run", squares / all, p, s, static_cast<double>(run), Quantity::count};
  }
  return worst;
}

std::optional<Place> walking_zero(const Repeats& repeats, const std::vector<double>& residual,
                                  const std::vector<double>& weight) {
  const Saturated left = saturate(repeats, residual, weight);
  if (!(left.dof >= 8.0)) return std::nullopt;
  std::vector<double> before(repeats.passes, std::numeric_limits<double>::quiet_NaN());
  double products = 0.0, pairs = 0.0, used = 0.0;
  for (std::size_t i = 0; i < left.e.size(); ++i) {
    if (!(weight[i] > 0.0)) continue;
    ++used;
    double& last = before[repeats.pass[i]];
    if (std::isfinite(last)) products += last * left.e[i], ++pairs;
    last = left.e[i];
  }
  const double mean_square = left.squares / used;
  if (!(pairs >= 20.0) || !(mean_square > 0.0)) return std::nullopt;
  const double r = products / pairs / mean_square;  // 0 +- 1/sqrt(pairs) without a memory
  const double p = 0.5 * std::erfc(r * std::sqrt(pairs / 2.0));
  if (!(p < memory_p)) return std::nullopt;
  const double square = r * mean_square * static_cast<double>(repeats.passes) * 70.0 / 18.0;
  return Place{"time", 0.0, p, std::sqrt(square)};
}

}  // namespace nonio::model
