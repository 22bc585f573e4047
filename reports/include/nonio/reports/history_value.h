// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "nonio/sdk/history.h"

namespace nonio::reports {

/// Standard uncertainty of the value as in the campaign's results: `u`, from the scatter of the
/// readings, and the additional part `u_common`. A negative `u_common` means that the results state
/// less than `u`.
inline double u_of_value(const HistoryPoint& p) {
  return std::sqrt(std::max(0.0, p.u * p.u + p.u_common * std::fabs(p.u_common)));
}

}  // namespace nonio::reports
