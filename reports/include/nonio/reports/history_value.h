// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "nonio/sdk/history.h"

namespace nonio::reports {

/// Standard uncertainty of the value, as the campaign's results state it. `u` alone compares
/// campaigns: what the scatter of the readings shows. `u_common` is what the value has beyond it;
/// negative: the results state less than the scatter shows.
inline double u_of_value(const HistoryPoint& p) {
  return std::sqrt(std::max(0.0, p.u * p.u + p.u_common * std::fabs(p.u_common)));
}

}  // namespace nonio::reports
