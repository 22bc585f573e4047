// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "nonio/math/diagonals.h"

namespace nonio::math {

template <class T>
std::vector<std::size_t> of_direction(const std::vector<T>& curves, int direction) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < curves.size(); ++k)
    if (curves[k].direction == direction) out.push_back(k);
  return out;
}

/// Checks that the lengths, numbers of stops and directions of the readings allow a solution.
Expected<void> check(const DiagonalReadings& r);

}  // namespace nonio::math
