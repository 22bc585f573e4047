// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::reading {

/// A stroke: the readings of one run in one direction along one line.
struct Stroke {
  std::uint32_t line = 0, run = 0;
  int direction = 0;
  std::vector<double> target, deviation;
  std::vector<double> as_taken;     ///< deviations in the order of measurement
  std::size_t first = 0, last = 0;  ///< first and last row, in the order of measurement
  int sense = 0;                    ///< +1: targets rise, -1: they fall; 0: neither
  std::size_t backwards = 0;        ///< number of steps against the direction of most steps
  double turns_at = 0.0;            ///< lower target of the first backward step, m or rad
  bool alone = false;  ///< no row of another stroke is between its rows in the order of measurement
  bool alone_in_file = false;  ///< no row of another stroke is between its rows in the file
};

/// All strokes of a measurement, in the order in which they began. The readings of each are sorted
/// by target.
struct Passes {
  std::vector<Stroke> strokes;
  double step =
      0.0;  ///< least difference of unequal readings, or their last decimal if finer; 0: all equal
};

/// Returns the strokes of a measurement; none if it has no axis.
Passes passes_of(const Observations& o);

/// Returns the run and direction of a stroke for messages: "3 +".
std::string name_of(const Stroke& s);

/// Subtracts the least-squares line through the values at these positions.
void take_line_out(const std::vector<double>& at, std::vector<double>& values);

/// Reports a measurement if a part of its runs or targets seems to be from another machine than the
/// rest.
void implausible_halves(const Passes& passes, bool angular, std::vector<Finding>& out);

/// Reports a value that marks a missing reading, a reading far from the others, a pass that equals
/// the mean of the others, and exchanged targets.
void implausible_values(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Reports passes that are copies. With `with_directions`, it also reports, in a measurement of one
/// line, directions that are swapped, turned or contradict the order of the rows, a pass whose
/// deviations have another order of magnitude, and what `implausible_values` and
/// `implausible_halves` report.
void implausible_passes(const Passes& passes, const Observations& o, bool with_directions,
                        std::vector<Finding>& out);

/// Reports a pass, or all passes of one direction, with the opposite sign or in reverse order.
void turned_passes(const Passes& passes, bool rotary, std::vector<Finding>& out);

/// Reports a pass that was copied one row too high or too low: it agrees with the others only if
/// each reading is assigned to the adjacent target. At least two other passes of its direction are
/// required.
void shifted_rows(const Passes& passes, Quantity deviation, std::vector<Finding>& out);

/// Reports passes in which more readings are equal than chance allows.
void implausible_copies(const Passes& passes, const Observations& o, std::vector<Finding>& out);

/// Reports passes, or numerous readings at the same places, that an earlier measurement of the
/// campaign contains too. `passes` contains the strokes of each measurement.
std::vector<Finding> passes_of_another_measurement(const Campaign& campaign,
                                                   const std::vector<Observations>& all,
                                                   const std::vector<Passes>& passes);

/// Reports implausible temperatures, pressures and humidities, and, if `with_times`, implausible
/// times.
void implausible_columns(const Measurement& m, const Passes& passes, const Observations& o,
                         bool with_times, std::vector<Finding>& out);

}  // namespace nonio::reading
