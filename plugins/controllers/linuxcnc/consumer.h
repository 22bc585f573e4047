// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "nonio/math/compensation.h"
#include "nonio/sdk/error.h"

/// The controller as its source code and runs of it show: reads a COMP_FILE and says what it then
/// does to the joint. Shares nothing with the code that writes the file.
namespace nonio::linuxcnc {

struct Machine {
  int type = 0;            ///< COMP_FILE_TYPE
  double per_si = 1e3;     ///< file units per m or rad
  std::size_t most = 256;  ///< lines that are kept
};

/// How many lines the reader takes before it stops without a word.
std::size_t lines_taken(std::string_view bytes, const Machine& machine);

Expected<math::Correction> load(std::string_view bytes, const Machine& machine);

}  // namespace nonio::linuxcnc
