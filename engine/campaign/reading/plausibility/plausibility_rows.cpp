// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading {
namespace {

/// Mean of the other passes, and variance of a reading about this mean.
struct OtherPasses {
  std::vector<double> mean;  ///< NaN if fewer than two other passes have the target
  double variance = 0.0;
};

using MeansByTarget = std::map<double, RunningMean>;
using MeansByDirection = std::map<std::pair<std::uint32_t, int>, MeansByTarget>;

MeansByDirection means_of(const std::vector<Stroke>& strokes) {
  MeansByDirection means;
  for (const Stroke& s : strokes) {
    MeansByTarget& at = means[{s.line, s.direction}];
    for (std::size_t i = 0; i < s.target.size(); ++i) at[s.target[i]].add(s.deviation[i]);
  }
  return means;
}

/// `all`: means including `own`.
OtherPasses other_passes_of(const Stroke& own, const MeansByTarget& all) {
  OtherPasses out;
  double squares = 0.0, freedom = 0.0, count = 0.0, places = 0.0;
  for (const double target : own.target) {
    RunningMean others = all.at(target);
    const auto [from, to] = std::equal_range(own.target.begin(), own.target.end(), target);
    for (auto i = from; i != to; ++i)
      others = others.without(own.deviation[static_cast<std::size_t>(i - own.target.begin())]);
    out.mean.push_back(others.count < 2.0 ? std::nan("") : others.mean);
    squares += others.squares;
    if (others.count < 2.0) continue;
    freedom += others.count - 1.0;
    count += others.count, ++places;
  }
  if (freedom > 0.0) out.variance = squares / freedom * (1.0 + places / count);
  return out;
}

/// Returns variances about the others, without the zero of the pass: as listed, and with each
/// reading assigned to the target `by` rows further. Both use the same `used` rows.
std::pair<double, double> variances(const Stroke& own, const OtherPasses& others, int by,
                                    std::size_t& used) {
  std::vector<double> listed, moved;
  for (std::size_t i = 0; i < own.target.size(); ++i) {
    const auto k = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + by);
    if (k >= own.target.size()) continue;
    const double a = own.deviation[i] - others.mean[i], b = own.deviation[i] - others.mean[k];
    if (std::isfinite(a) && std::isfinite(b)) listed.push_back(a), moved.push_back(b);
  }
  used = listed.size();
  const auto variance = [&](const std::vector<double>& r) {
    double mean = 0.0, squares = 0.0;
    for (const double x : r) mean += x / static_cast<double>(r.size());
    for (const double x : r) squares += (x - mean) * (x - mean);
    return squares / (static_cast<double>(r.size()) - 1.0);
  };
  return used < 2 ? std::pair{0.0, 0.0} : std::pair{variance(listed), variance(moved)};
}

}  // namespace

void shifted_rows(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  // Noise gives such a likelihood ratio in at most one of e^9 passes.
  constexpr double evidence = 9.0;
  constexpr std::size_t fewest = 7;
  const MeansByDirection means = means_of(passes.strokes);
  for (const Stroke& own : passes.strokes) {
    const OtherPasses others = other_passes_of(own, means.at({own.line, own.direction}));
    if (!(others.variance > 0.0)) continue;
    for (const int by : {1, -1}) {
      std::size_t used = 0;
      const auto [listed, moved] = variances(own, others, by, used);
      if (used < fewest || !(listed > 2.0 * others.variance) || !(moved < 2.0 * others.variance))
        continue;
      const double ratio = listed / std::max(moved, 1e-3 * others.variance);
      if (!(0.5 * static_cast<double>(used) * std::log(ratio) > evidence)) continue;
      out.push_back({.id = "plausibility.rows-shifted",
                     .attention = true,
                     .evidence = {{"listed", std::sqrt(listed), deviation},
                                  {"moved", std::sqrt(moved), deviation}},
                     .texts = {{"which", name_of(own)}}});
      break;
    }
  }
}

}  // namespace nonio::reading
