// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "nonio/math/compensation.h"
#include "nonio/sdk/error.h"

/// The control as its manuals describe it: reads a .COM table and says what it then does to the
/// axis. Shares nothing with the code that writes the table.
namespace nonio::heidenhain {

struct Machine {
  std::string axis = "X";    ///< the column that is active for the axis itself
  bool rotary = false;       ///< table values are deg, else mm
  std::size_t points = 256;  ///< rows that are taken
  double backlash = 0.0;     ///< as entered, mm or deg; positive: the encoder leads
};

/// Either layout, told apart by the first line. m or rad.
Expected<math::Correction> load(std::string_view com, const Machine& machine);

/// The value after "backLash = " in the words beside a table; mm or deg.
Expected<double> backlash_entered(std::string_view words);

/// The .COM file that the .CMA names for an axis in its active line (or in its line 0 if the
/// layout marks none); empty if there is none.
Expected<std::string> assigned(std::string_view cma, std::string_view axis);

}  // namespace nonio::heidenhain
