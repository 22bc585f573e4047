// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/differences.h"
#include "nonio/sdk/plugin.h"
#include "tracks.h"

namespace nonio::thermal {

struct Wish {
  double window = 3600.0;   ///< s
  double remaining = 1e-6;  ///< m, permitted change after the warm-up
};

using Item = math::Difference;

/// Results of the tracks, and findings for results that cannot be computed.
struct Worked {
  std::vector<Item> items;
  std::vector<Finding> findings;
  std::vector<Series> series;
  PointTable points;
  double drift = 0.0;  ///< largest change in a window of a machine at rest, m; 0 if not known
  std::string drift_sensor;
};

Worked work(const Tracks&, const Measurement&, const Wish&);

}  // namespace nonio::thermal
