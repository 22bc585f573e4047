// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/math/compensation.h"
#include "nonio/sdk/error.h"

/// The control as the manual describes it: reads the files and says what it then does to an axis.
/// Shares nothing with the code that writes them.
namespace nonio::siemens {

struct Machine {
  std::string axis = "AX1";          ///< as the files name it
  int measuring_system = 0;          ///< the active one
  bool rotary = false;               ///< file values are deg, else mm
  std::size_t encoder_points = 200;  ///< MD38000
  std::size_t cec_points = 200;      ///< MD18342
  double backlash = 0.0;             ///< MD32450 as it is if no file sets it, mm or deg
};

/// After these files are loaded and the functions enabled. m or rad.
Expected<math::Correction> load(const std::vector<std::string_view>& files, const Machine& machine);

/// What the CEC tables of these files add to axis `output` at a position of the linear axis
/// `input`, both as the files name them.
Expected<math::Correction> load_cross(const std::vector<std::string_view>& files,
                                      const std::string& input, const std::string& output,
                                      const Machine& machine);

}  // namespace nonio::siemens
