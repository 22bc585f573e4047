// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/controllers/axis_job.h"

/// How large a table is, and how large it may be.
namespace nonio::controllers {

/// What the control adds by a table: the largest size and the steepest change between neighbouring
/// points. SI.
struct TableSize {
  double largest = 0.0, largest_at = 0.0;
  double slope = 0.0, slope_from = 0.0;  ///< m per m or rad per rad; where that interval begins
  double shortest = 0.0;                 ///< distance of two points

  void take(const std::vector<double>& position, const std::vector<double>& added);
};

/// Of the tables that correct this axis by itself, as the control reads them, at these positions.
TableSize size_of(const std::vector<LoadedTable>&, const std::string& axis,
                  const std::vector<double>& position);

/// True, with findings, where the table is larger or steeper than twice what the measurement can
/// explain (E, the steepest error between neighbouring targets, the present backlash; `step` is
/// that of an entry), or than the maker allows: settings largest_um (largest_arcsec) and
/// slope_um_per_m (slope_arcsec_per_deg).
bool oversized(const AxisJob&, const TableSize&, double step, OutputResult&);

/// "largest entry 8.143 um at 400.0 mm, steepest 20.36 um/m from 350.0 mm; E as measured ...".
std::string size_words(const AxisJob&, const TableSize&);

/// A note that states where the table is zero, and one that states how large it is.
void note_zero(const AxisJob&, double zero, OutputResult&);
void note_size(const AxisJob&, const TableSize&, OutputResult&);

}  // namespace nonio::controllers
