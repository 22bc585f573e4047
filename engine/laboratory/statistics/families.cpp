// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/families.h"

#include <algorithm>
#include <numeric>

namespace nonio::statistics {
namespace {

std::vector<std::size_t> ascending(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  return order;
}

}  // namespace

std::vector<double> benjamini_hochberg(const std::vector<double>& p) {
  const auto order = ascending(p);
  const auto m = static_cast<double>(p.size());
  std::vector<double> out(p.size(), 1.0);
  double least = 1.0;
  for (std::size_t i = p.size(); i-- > 0;) {
    least = std::min(least, p[order[i]] * m / static_cast<double>(i + 1));
    out[order[i]] = least;
  }
  return out;
}

std::vector<double> holm(const std::vector<double>& p) {
  const auto order = ascending(p);
  std::vector<double> out(p.size(), 1.0);
  double most = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    most = std::max(most, std::min(1.0, p[order[i]] * static_cast<double>(p.size() - i)));
    out[order[i]] = most;
  }
  return out;
}

}  // namespace nonio::statistics
