// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::reading {

/// Readings of one run in one direction along one line.
struct Stroke {
  std::uint32_t line = 0, run = 0;
  int direction = 0;
  std::vector<double> target, deviation;
  std::vector<double> as_taken;     ///< deviations in the order of measurement
  std::size_t first = 0, last = 0;  ///< rows in the order of measurement
  int sense = 0;                    ///< +1 for rising targets, -1 for falling targets, 0 otherwise
  std::size_t backwards = 0;        ///< number of steps against the direction of most steps
  double turns_at = 0.0;            ///< lower target of the first backward step, m or rad
  bool alone = false;               ///< in time, no row of another stroke is between the rows
  bool alone_in_file = false;       ///< in the file, no row of another stroke is between the rows
};

/// Strokes in the order of their first rows. The readings are sorted by target.
struct Passes {
  std::vector<Stroke> strokes;
  double step = 0.0;  ///< step of the digits, m or rad; 0 if all readings are equal
};

/// Returns no strokes without an axis.
Passes passes_of(const Observations& o);

/// Returns run and direction, for example "3 +".
std::string name_of(const Stroke& s);

/// Subtracts the least-squares line.
void take_line_out(const std::vector<double>& at, std::vector<double>& values);

/// Reports runs or targets that seem to come from another machine.
void implausible_halves(const Passes& passes, bool angular, std::vector<Finding>& out);

/// Reports marks of missing readings, misreadings, passes of means, and exchanged targets.
void implausible_values(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Reports copies. `with_directions` adds, for one line, directions that are swapped, turned or
/// contradict the order of the rows, passes of another order of magnitude, and the findings of
/// `implausible_values` and `implausible_halves`.
void implausible_passes(const Passes& passes, const Observations& o, bool with_directions,
                        std::vector<Finding>& out);

/// Reports passes or directions with the opposite sign or in reverse order.
void turned_passes(const Passes& passes, bool rotary, std::vector<Finding>& out);

/// Reports a pass that agrees with two or more others only if each reading belongs to the next
/// target.
void shifted_rows(const Passes& passes, Quantity deviation, std::vector<Finding>& out);

void implausible_copies(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Reports passes, or numerous readings at the same places, that an earlier measurement contains.
std::vector<Finding> passes_of_another_measurement(const Campaign& campaign,
                                                   const std::vector<Observations>& all,
                                                   const std::vector<Passes>& passes);

void implausible_columns(const Measurement& m, const Passes& passes, const Observations& o,
                         bool with_times, std::vector<Finding>& out);

}  // namespace nonio::reading
