// SPDX-License-Identifier: Apache-2.0
// Two queues of candidates find the largest range in O(n). Decision of the analysis:
// docs/dev/constants.md, A16.
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "nonio/math/thermal.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::math {

namespace {

/// s; tolerance for rounding, so that a window of an hour includes the reading after one hour.
constexpr double time_slack = 1e-6;

RangeOf range_between(const Track& k, std::size_t first, std::size_t last) {
  RangeOf out;
  out.low = out.high = first;
  for (std::size_t i = first; i <= last; ++i) {
    if (k.d[i] < k.d[out.low]) out.low = i;
    if (k.d[i] > k.d[out.high]) out.high = i;
  }
  out.range = k.d[out.high] - k.d[out.low];
  out.from = k.time[first], out.to = k.time[last];
  return out;
}

}  // namespace

std::optional<RangeOf> whole_range(const Track& k) {
  if (k.size() == 0) return {};
  return range_between(k, 0, k.size() - 1);
}

std::optional<RangeOf> first_range(const Track& k, double w) {
  if (k.size() < 2 || k.time.back() - k.time.front() < w - time_slack) return {};
  std::size_t last = 0;
  while (last + 1 < k.size() && k.time[last + 1] - k.time.front() <= w + time_slack) ++last;
  return range_between(k, 0, last);
}

std::optional<RangeOf> largest_range(const Track& k, double w) {
  if (k.size() < 2 || k.time.back() - k.time.front() < w - time_slack) return {};
  // Indices ascend; the values ascend in `low` and descend in `high`.
  std::deque<std::size_t> low, high;
  std::optional<RangeOf> best;
  std::size_t first = 0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    while (!low.empty() && k.d[low.back()] >= k.d[i]) low.pop_back();
    while (!high.empty() && k.d[high.back()] <= k.d[i]) high.pop_back();
    low.push_back(i), high.push_back(i);
    while (k.time[i] - k.time[first] > w + time_slack) ++first;
    while (low.front() < first) low.pop_front();
    while (high.front() < first) high.pop_front();
    const double range = k.d[high.front()] - k.d[low.front()];
    if (!best || range > best->range)
      best = RangeOf{range, low.front(), high.front(), k.time[first], k.time[i]};
  }
  return best;
}

ReadingNoise reading_noise(const Track& k) {
  if (k.size() < 4) return {};
  double squares = 0.0;
  for (std::size_t i = 1; i + 1 < k.size(); ++i) {
    // Weights of a straight line through the two adjacent readings: 1/2, 1/2 for even steps.
    const double a = (k.time[i + 1] - k.time[i]) / (k.time[i + 1] - k.time[i - 1]), b = 1.0 - a;
    const double off = k.d[i] - a * k.d[i - 1] - b * k.d[i + 1];
    squares += off * off / (1.0 + a * a + b * b);
  }
  const double n = static_cast<double>(k.size()) - 2.0;
  return {std::sqrt(squares / n), 18.0 / 35.0 * n};
}

double range_excess(std::span<const double> d, double s) {
  constexpr int repeats = 40;
  constexpr std::size_t most = 4096;
  if (d.size() < 2 || !(s > 0.0)) return 0.0;
  const auto [low, high] = std::minmax_element(d.begin(), d.end());
  const double range = *high - *low;
  const std::size_t step = d.size() / most + 1;
  SplitMix64 random(0x6e6f6e696f);
  double sum = 0.0;
  for (int r = 0; r < repeats; ++r) {
    double least = INFINITY, largest = -INFINITY;
    for (std::size_t i = 0; i < d.size(); i += step) {
      // The sum of twelve uniform numbers is sufficiently normal, and equal on every processor.
      double z = -6.0;
      for (int q = 0; q < 12; ++q) z += random.uniform();
      least = std::min(least, d[i] + s * z), largest = std::max(largest, d[i] + s * z);
    }
    sum += std::max(0.0, largest - least - range);
  }
  return sum / repeats;
}

namespace {

using ByPlace = std::map<std::pair<double, int>, const Visits*>;

std::size_t whole_cycles(const std::vector<Visits>& all) {
  std::size_t n = all.empty() ? 0 : all.front().track.size();
  for (const Visits& v : all) n = std::min(n, v.track.size());
  return n;
}

double time_of_cycle(const std::vector<Visits>& all, std::size_t j) {
  double sum = 0.0;
  for (const Visits& v : all) sum += v.track.time[j] / static_cast<double>(all.size());
  return sum;
}

}  // namespace

Track growth(const std::vector<Visits>& all) {
  Track out;
  double mean = 0.0, squares = 0.0;
  for (const Visits& v : all) mean += v.position / static_cast<double>(all.size());
  for (const Visits& v : all) squares += (v.position - mean) * (v.position - mean);
  if (!(squares > 0.0)) return out;
  for (std::size_t j = 0; j < whole_cycles(all); ++j) {
    double slope = 0.0;
    for (const Visits& v : all)
      slope += (v.position - mean) * (v.track.d[j] - v.track.d[0]) / squares;
    out.time.push_back(time_of_cycle(all, j)), out.d.push_back(slope);
  }
  return out;
}

Track reversal_change(const std::vector<Visits>& all) {
  Track out;
  ByPlace place;
  for (const Visits& v : all) place[{v.position, v.direction}] = &v;
  std::vector<std::pair<const Visits*, const Visits*>> pairs;
  for (const Visits& v : all)
    if (const auto minus = place.find({v.position, -1}); v.direction > 0 && minus != place.end())
      pairs.emplace_back(&v, minus->second);
  if (pairs.empty()) return out;
  for (std::size_t j = 0; j < whole_cycles(all); ++j) {
    double sum = 0.0;
    for (const auto& [plus, minus] : pairs)
      sum += plus->track.d[j] - minus->track.d[j] - plus->track.d[0] + minus->track.d[0];
    out.time.push_back(time_of_cycle(all, j));
    out.d.push_back(sum / static_cast<double>(pairs.size()));
  }
  return out;
}

}  // namespace nonio::math
