// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "design.h"
#include "nonio/model/comparison.h"

namespace nonio::model {

/// How the readings of a table repeat each other. A target is a place in the machine on one line, a
/// cell is a target reached from one side, a pass is one run in one direction on one line.
struct Repeats {
  std::vector<std::uint32_t> target, cell, pass;  // of each reading
  std::vector<std::uint32_t> side;                // of each pass: line and direction together
  std::vector<double> order;                      // -1..1: where in its pass a reading was taken
  std::size_t targets = 0, cells = 0, passes = 0, sides = 0;

  explicit Repeats(const Observations&);
};

/// deviation = mean of its cell + offset (+ slope, + curvature) of its pass over `order` + e.
struct Saturated {
  std::vector<double> e;  ///< of each reading, those of weight 0 too
  double squares = 0.0, dof = 0.0;
};
Saturated saturate(const Repeats&, const std::vector<double>& y, const std::vector<double>& weight);

/// Columns that the passes of so many readings share: offset, slope, curvature. Few readings too: a
/// growth that is missing leaves a slope of each pass.
inline Index shared_columns(Index readings) {
  return readings >= 8 ? 3 : readings >= 4 ? 2 : readings >= 1 ? 1 : 0;
}

/// Of each of `rows` its value less the median of the other readings of its target.
std::vector<double> apart_from_others(const Repeats&, const std::vector<std::uint32_t>& rows,
                                      const std::vector<double>& e);

/// Readings that contradict their repeats and their neighbours: found by medians, then tested
/// against the scatter of the others (Student, corrected for the number of readings). Of the model
/// only the set-up is taken out.
std::vector<Suspect> suspects_of(const Observations&, const Repeats&,
                                 const std::vector<Term>& model);

}  // namespace nonio::model
