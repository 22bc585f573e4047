// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rotary_chain.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_chain {

/// The order of the axes, as the options state it.
struct Chain {
  std::vector<std::string>
      axes;  ///< tables from the bed outwards, then heads from the bed outwards
  std::size_t tables = 0;
  bool is_head(std::size_t axis) const { return axis >= tables; }
};

/// The centres of all measurements that have the angles of both axes, and have one reference point.
struct Places {
  std::vector<math::ChainReading> readings;  ///< in the order in which they were read
  math::ChainOrder order;
  std::vector<const Observations*> tables;  ///< of `used`
  std::vector<std::string> used, left_out;  ///< ids; a ball each
  std::vector<const Measurement*> tools;    ///< the first measurement with each of them
  double stated_u = 0.0;                    ///< of a centre by its reader; 0: not stated
  std::vector<Finding> findings;
  bool sound = true;
};

/// Readings of several runs or directions at one position of both axes are one centre with their
/// number as weight. A position that is given twice in one run and direction is a finding.
Places places_of(const AnalysisInput&, const Chain&);

/// Of the same state of the machine, before or after an adjustment.
bool same_state(const Measurement&, const Measurement&);

}  // namespace nonio::rotary_chain
