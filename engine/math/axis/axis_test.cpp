// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::math {
namespace {

bool counts(const Observations& o, std::size_t row) {
  const auto& axis = o.axes.front();
  return axis.approach[row] != 0 && std::isfinite(axis.position[row]);
}

void keep_distinct(std::vector<double>& x) {
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
}

// Duplicates are removed whenever the list has doubled: memory grows with the targets, not rows.
std::vector<double> distinct_targets(const Observations& o) {
  std::vector<double> targets;
  std::size_t limit = 1U << 16U;
  for (std::size_t row = 0; row < o.size(); ++row) {
    if (!counts(o, row)) continue;
    const double position = o.axes.front().position[row] + 0.0;  // -0.0 becomes 0.0
    if (!targets.empty() && targets.back() == position) continue;
    targets.push_back(position);
    if (targets.size() < limit) continue;
    keep_distinct(targets);
    limit = std::max(limit, 2 * targets.size());
  }
  keep_distinct(targets);
  targets.shrink_to_fit();
  return targets;
}

}  // namespace

// Arranges by a counting sort, which needs 16 bytes per row and 24 bytes per target.
AxisTest AxisTest::arrange(const Observations& o) {
  AxisTest test;
  test.starts_.assign(1, 0);
  if (o.axes.empty()) return test;
  const auto& axis = o.axes.front();
  test.rotary = axis.rotary;
  if (axis.position.size() != o.size() || axis.approach.size() != o.size()) return test;
  test.targets = distinct_targets(o);

  std::size_t last = 0;
  const auto part_of = [&](std::size_t row) {
    const double position = axis.position[row];
    if (last >= test.targets.size() || test.targets[last] != position)
      last = static_cast<std::size_t>(
          std::lower_bound(test.targets.begin(), test.targets.end(), position) -
          test.targets.begin());
    return 2 * last + (axis.approach[row] > 0 ? 0U : 1U);
  };
  std::vector<std::size_t>& starts = test.starts_;
  starts.assign(2 * test.targets.size() + 1, 0);
  for (std::size_t row = 0; row < o.size(); ++row)
    if (counts(o, row)) ++starts[part_of(row) + 1];
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    if (starts[k + 1] > 0) (k % 2 == 0 ? test.has_plus_ : test.has_minus_) = true;
    starts[k + 1] += starts[k];
  }
  test.readings_.resize(starts.back());
  // Filling advances each start to its end, which is the next start; shift them back afterwards.
  for (std::size_t row = 0; row < o.size(); ++row)
    if (counts(o, row))
      test.readings_[starts[part_of(row)]++] = {
          o.deviation[row], row < o.run.size() ? o.run[row] : 1, static_cast<std::uint32_t>(row)};
  for (std::size_t k = starts.size() - 1; k > 0; --k) starts[k] = starts[k - 1];
  starts[0] = 0;

  const auto by_run = [](const Reading& a, const Reading& b) {
    return a.run != b.run ? a.run < b.run : a.row < b.row;
  };
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    const auto begin = test.readings_.begin() + static_cast<std::ptrdiff_t>(starts[k]);
    const auto end = test.readings_.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]);
    if (!std::is_sorted(begin, end, by_run)) std::sort(begin, end, by_run);
  }
  return test;
}

AxisTest AxisTest::only(std::span<const std::size_t> kept) const {
  AxisTest test;
  test.rotary = rotary;
  test.starts_.assign(1, 0);
  for (const std::size_t i : kept) {
    test.targets.push_back(targets[i]);
    for (const auto& from : {plus(i), minus(i)}) {
      test.readings_.insert(test.readings_.end(), from.begin(), from.end());
      test.starts_.push_back(test.readings_.size());
    }
    test.has_plus_ = test.has_plus_ || !plus(i).empty();
    test.has_minus_ = test.has_minus_ || !minus(i).empty();
  }
  return test;
}

bool AxisTest::complete() const { return least_approaches() > 0; }

std::size_t AxisTest::least_approaches() const {
  if (targets.empty()) return 0;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (has_plus_) least = std::min(least, plus(i).size());
    if (has_minus_) least = std::min(least, minus(i).size());
  }
  return least;
}

std::size_t AxisTest::most_approaches() const {
  std::size_t most = 0;
  for (std::size_t i = 0; i < targets.size(); ++i)
    most = std::max({most, plus(i).size(), minus(i).size()});
  return most;
}

std::vector<double> deviations(std::span<const AxisTest::Reading> readings) {
  std::vector<double> x;
  x.reserve(readings.size());
  for (const auto& r : readings) x.push_back(r.deviation);
  return x;
}

}  // namespace nonio::math
