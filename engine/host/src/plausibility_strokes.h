// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio::host {

/// The readings that one direction of one run took along one line, in the order of the file.
struct Stroke {
  std::uint32_t line = 0, run = 0;
  int direction = 0;
  std::vector<double> target, deviation;
  std::vector<double> as_taken;     ///< the deviations in the order in which they were taken
  std::size_t first = 0, last = 0;  ///< rows in the order in which they were taken
  int sense = 0;                    ///< +1: targets rise, -1: they fall; 0: neither
  bool alone = false;               ///< no row of another stroke between its own
  bool alone_in_file = false;       ///< the same in the order of the rows
};

/// In the order in which they were begun; within each by target.
std::vector<Stroke> strokes_of(const Observations& o);

/// "3 +", of a run and direction.
std::string name_of(const Stroke& s);

/// The smallest difference of two readings that are not the same; 0 if all are.
double step_of(const std::vector<Stroke>& strokes);

}  // namespace nonio::host
