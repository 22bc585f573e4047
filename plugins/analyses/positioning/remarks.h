// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/positioning.h"
#include "nonio/sdk/results.h"

namespace nonio::positioning {

using Rules = std::vector<const math::PositioningRule*>;

/// The constant that a rule without offset takes off.
struct TakenOff {
  double value = 0.0;  ///< m or rad
  Quantity quantity = Quantity::deviation;
  std::string option;  ///< as nmtba_offset has it
};

/// Which rules, what each makes of the readings, how sure its formula is, and why the rules differ.
std::vector<Remark> remarks_on(const Rules&, const TakenOff&, bool with_U);

}  // namespace nonio::positioning
