// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "design.h"
#include "nonio/model/comparison.h"

namespace nonio::model {

/// Which readings of a table repeat each other. A target is a position in the machine on one line,
/// a cell is a target approached from one side, a pass is one run in one direction on one line.
struct Repeats {
  std::vector<std::uint32_t> target, cell, pass;  // group index of each reading
  std::vector<std::uint32_t> side;                // for each pass: index of its line and direction
  std::vector<double> order;  // order of each reading within its pass, scaled to -1..1
  std::size_t targets = 0, cells = 0, passes = 0, sides = 0;

  explicit Repeats(const Observations&);
};

/// Residuals e of the model deviation = mean of its cell + terms of its pass + e. The terms of a
/// pass are an offset and, in longer passes, a slope and a curvature over `order`.
struct Saturated {
  std::vector<double> e;  ///< residual of each reading, including those of weight 0
  double squares = 0.0, dof = 0.0;
  std::vector<double> share;  ///< of each reading in `dof`: what its cell and its pass leave of it
};
Saturated saturate(const Repeats&, const std::vector<double>& y, const std::vector<double>& weight);

/// Terms of a pass: offset, from 4 readings a slope (such as unmodeled growth), from 8 a curvature.
inline Index shared_columns(Index readings) {
  return readings >= 8 ? 3 : readings >= 4 ? 2 : readings >= 1 ? 1 : 0;
}

/// Returns, for each of `rows`, its value minus the median of the other readings of its target, or
/// of its cell if each cell of the target has at least four readings. With too few such readings,
/// the result is 0 if other targets are repeated, otherwise the value itself.
std::vector<double> apart_from_others(const Repeats&, const std::vector<std::uint32_t>& rows,
                                      const std::vector<double>& e);

/// Readings that contradict their repeats and adjacent readings: found by medians, then tested
/// against the scatter of the others (Student, corrected for the number of readings). Only set-up
/// effects are subtracted. Empty with fewer than 10 readings, with neither repeats nor a known
/// order, or if more than a quarter of the readings would be suspect.
std::vector<Suspect> suspects_of(const Observations&, const Repeats&,
                                 const std::vector<Term>& model);

}  // namespace nonio::model
