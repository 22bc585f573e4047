// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/observations.h"

namespace nonio::host::reading {

/// The readings that one direction of one run took along one line, in the order of the file.
struct Stroke {
  std::uint32_t line = 0, run = 0;
  int direction = 0;
  std::vector<double> target, deviation;
  std::vector<double> as_taken;     ///< the deviations in the order in which they were taken
  std::size_t first = 0, last = 0;  ///< rows in the order in which they were taken
  int sense = 0;                    ///< +1: targets rise, -1: they fall; 0: neither
  std::size_t backwards = 0;        ///< steps against the way that most of its steps go
  double turns_at = 0.0;            ///< the lower target of the first of these
  bool alone = false;               ///< no row of another stroke between its own
  bool alone_in_file = false;       ///< the same in the order of the rows
};

/// In the order in which they were begun; within each by target.
std::vector<Stroke> strokes_of(const Observations& o);

/// "3 +", of a run and direction.
std::string name_of(const Stroke& s);

/// The smallest difference of two readings that are not the same; 0 if all are.
double step_of(const std::vector<Stroke>& strokes);

/// The line of least squares out of the values at these places.
void take_line_out(const std::vector<double>& at, std::vector<double>& values);

/// Beyond so many readings what would have to be sorted by target is not looked at.
inline constexpr std::size_t most_sorted = 20000;

/// Runs or targets of which one part is of another machine than the rest.
void implausible_halves(const std::vector<Stroke>& strokes, bool angular,
                        std::vector<Finding>& out);

/// A value that stands for a reading that was not taken, a pass of means, targets exchanged.
void implausible_values(const std::vector<Stroke>& strokes, const Observations& o,
                        std::vector<Finding>& out);

}  // namespace nonio::host::reading
