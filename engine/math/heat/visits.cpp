// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "nonio/math/thermal.h"

namespace nonio::math {

InTime in_time(const Observations& o, std::vector<std::size_t> rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return o.time[a] < o.time[b]; });
  InTime out;
  double n = 0.0;
  for (const std::size_t i : rows) {
    if (out.rows.empty() || o.time[i] > out.track.time.back()) {
      out.rows.push_back(i);
      out.track.time.push_back(o.time[i]), out.track.d.push_back(0.0);
      n = 0.0;
    }
    n += 1.0;
    out.track.d.back() += (o.deviation[i] - out.track.d.back()) / n;
  }
  return out;
}

std::vector<Visits> visits_of(const Observations& o) {
  std::vector<Visits> out;
  if (o.size() == 0 || o.axes.empty()) return out;
  std::map<std::pair<double, int>, std::vector<std::size_t>> places;
  const auto& axis = o.axes.front();
  const double start = *std::min_element(o.time.begin(), o.time.end());
  for (std::size_t i = 0; i < o.size(); ++i)
    places[{axis.position[i], axis.approach.empty() ? 1 : axis.approach[i]}].push_back(i);
  for (auto& [place, rows] : places) {
    Visits v{place.first, place.second, in_time(o, std::move(rows)).track};
    for (double& t : v.track.time) t -= start;
    if (v.track.size() > 1) out.push_back(std::move(v));
  }
  return out;
}

}  // namespace nonio::math
