// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "nonio/math/compensation.h"
#include "nonio/sdk/error.h"

/// The control as its manuals describe it: reads a punched parameter text and says what it then
/// does to the axis. Shares nothing with the code that writes the text.
namespace nonio::fanuc {

struct Machine {
  int axis = 1;                       ///< controlled axis number
  bool rotary = false;                ///< a turn of 3624 and 3625, else a length
  double detection = 1e-6;            ///< detection unit, m or rad
  double interval_unit = 1e-6;        ///< unit of 3624 and 3625, m or rad
  double reference = 0.0;             ///< where the reference position is, m or rad
  std::int64_t least = -7, most = 7;  ///< what one number holds
  bool bidirectional = false;         ///< 3605#0, set by hand
  bool returns_towards_plus = true;   ///< direction of reference return
  double backlash = 0.0;  ///< what 1851 amounts to if the text does not set it, m or rad
};

Expected<math::Correction> load(std::string_view text, const Machine& machine);

}  // namespace nonio::fanuc
