// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::reading {

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

/// All of a measurement, in the order in which they were begun; within each by target.
struct Passes {
  std::vector<Stroke> strokes;
  double step =
      0.0;  ///< the smallest difference of two readings that are not the same; 0 if all are
};

/// None if there is no axis.
Passes passes_of(const Observations& o);

/// "3 +", of a run and direction.
std::string name_of(const Stroke& s);

/// The line of least squares out of the values at these places.
void take_line_out(const std::vector<double>& at, std::vector<double>& values);

/// Runs or targets of which one part is of another machine than the rest.
void implausible_halves(const Passes& passes, bool angular, std::vector<Finding>& out);

/// A value that stands for a reading that was not taken, a pass of means, targets exchanged.
void implausible_values(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Passes that are copies, directions that are swapped or go against the order of the rows.
void implausible_passes(const Passes& passes, const Observations& o, bool with_directions,
                        std::vector<Finding>& out);

/// A pass, or all of one direction, with the other sign or from the other end.
void turned_passes(const Passes& passes, bool rotary, std::vector<Finding>& out);

/// A pass that agrees with the others only if each reading belongs to the target one row further:
/// copied one row too high or too low. Two passes of its direction besides it, or nothing is
/// reported.
void shifted_rows(const Passes& passes, Quantity deviation, std::vector<Finding>& out);

/// Passes of which more agrees than chance allows.
void implausible_copies(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Passes that an earlier measurement of the campaign contains too. `passes`: of each one.
std::vector<Finding> passes_of_another_measurement(const Campaign& campaign,
                                                   const std::vector<Observations>& all,
                                                   const std::vector<Passes>& passes);

/// Temperatures, pressure, humidity and, if wanted, times.
void implausible_columns(const Measurement& m, const Passes& passes, const Observations& o,
                         bool with_times, std::vector<Finding>& out);

}  // namespace nonio::reading
