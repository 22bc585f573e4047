// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/volume_map.h"

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

}  // namespace nonio::math
