// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/constants.h"
#include "nonio/math/circle.h"

namespace nonio::math {

CircleNoise::CircleNoise(std::span<const CircleReading> readings, const CircleModel& model,
                         const CauseFit& fit)
    : truth_(readings.begin(), readings.end()), from_(readings.size()) {
  std::vector<std::size_t> order(readings.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto group = [&](std::size_t i) {
    return std::pair(readings[i].direction, readings[i].run);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(group(a), readings[a].angle) < std::pair(group(b), readings[b].angle);
  });
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    std::vector<double> residuals;
    std::vector<std::size_t> place;
    for (; end < order.size() && group(order[end]) == group(order[first]); ++end) {
      const std::size_t i = order[end];
      place.push_back(residuals.size());
      double& left = truth_[i].deviation;
      const double says = fit.radius_at(model, readings[i].angle, readings[i].direction),
                   off = left - says;
      if (model.leaves_out(readings[i].angle)) {
        // A spike is not noise; it is kept, reduced by the contribution of the noise.
        const double ratio = off / fit.s_reading;
        left = says + (std::fabs(ratio) > 1.0 ? off * (1.0 - 1.0 / (ratio * ratio)) : 0.0);
        continue;
      }
      residuals.push_back(off);
      left = says;
    }
    for (std::size_t k = first; k < end; ++k)
      from_[order[k]] = {residuals_.size(), residuals.size(), place[k - first]};
    residuals_.insert(residuals_.end(), residuals.begin(), residuals.end());
    first = end;
  }
}

std::vector<CircleReading> CircleNoise::turned(std::size_t k) const {
  std::vector<CircleReading> path = truth_;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const From& from = from_[i];
    if (from.count == 0) continue;
    const std::size_t by = (k + 1) * from.count / (times + 1);
    path[i].deviation += residuals_[from.first + (from.place + by) % from.count];
  }
  return path;
}

}  // namespace nonio::math
