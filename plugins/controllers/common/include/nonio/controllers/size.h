// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"

namespace nonio::controllers {

/// Largest absolute value that the control adds by a table, and the steepest change between
/// adjacent points; SI.
struct TableSize {
  double largest = 0.0, largest_at = 0.0;
  double slope = 0.0, slope_from = 0.0;  ///< m/m or rad/rad; start of the steepest interval
  double shortest = 0.0;                 ///< smallest distance of two points

  void take(const std::vector<double>& position, const std::vector<double>& added);
};

/// Size, at these positions, of the tables that compensate this axis by its own position.
TableSize size_of(const std::vector<LoadedTable>&, const std::string& axis,
                  const std::vector<double>& position);

/// Returns true, with findings, if the table is larger or steeper than twice what the measurement
/// can explain (E, the steepest error between adjacent targets, the present backlash; `step` is
/// that of an entry), or than the maker allows: settings largest_um (largest_arcsec) and
/// slope_um_per_m (slope_arcsec_per_deg).
bool oversized(const AxisJob&, const TableSize&, double step, OutputResult&);

/// "largest entry 8.143 um at 400.0 mm, steepest 20.36 um/m from 350.0 mm; E as measured ...".
std::string size_words(const AxisJob&, const TableSize&);

void note_zero(const AxisJob&, double zero, OutputResult&);
void note_size(const AxisJob&, const TableSize&, OutputResult&);

}  // namespace nonio::controllers
