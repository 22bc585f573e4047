// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/volume_map.h"

#include <algorithm>

namespace nonio::math {

std::vector<Corner> lattice(const Corner& low, const Corner& high, std::size_t parts) {
  std::array<std::size_t, 3> count{};
  for (std::size_t k = 0; k < 3; ++k) count[k] = high[k] > low[k] ? parts + 1 : 1;
  std::vector<Corner> nodes;
  for (std::size_t i = 0; i < count[0]; ++i)
    for (std::size_t j = 0; j < count[1]; ++j)
      for (std::size_t k = 0; k < count[2]; ++k) {
        Corner at = low;
        const std::array<std::size_t, 3> index{i, j, k};
        for (std::size_t a = 0; a < 3; ++a)
          if (count[a] > 1)
            at[a] +=
                (high[a] - low[a]) * static_cast<double>(index[a]) / static_cast<double>(parts);
        nodes.push_back(at);
      }
  return nodes;
}

Corner interpolated(const VolumeMap& map, const Corner& at) {
  const Corner low = map.nodes.front().at, high = map.nodes.back().at;
  std::array<std::size_t, 3> count{}, cell{};
  std::array<double, 3> part{};
  for (std::size_t k = 0; k < 3; ++k) {
    count[k] = high[k] > low[k] ? map.parts + 1 : 1;
    if (count[k] == 1) continue;
    const double steps = std::clamp((at[k] - low[k]) / (high[k] - low[k]), 0.0, 1.0) *
                         static_cast<double>(map.parts);
    cell[k] = std::min(static_cast<std::size_t>(steps), map.parts - 1);
    part[k] = steps - static_cast<double>(cell[k]);
  }
  Corner out{};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::size_t index = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t up = corner >> k & 1U;
      weight *= up != 0 ? part[k] : 1.0 - part[k];
      index = index * count[k] + std::min(cell[k] + up, count[k] - 1);
    }
    if (weight == 0.0) continue;
    for (std::size_t k = 0; k < 3; ++k) out[k] += weight * map.nodes[index].error[k];
  }
  return out;
}

}  // namespace nonio::math
