// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rotary_chain.h"
#include "nonio/sdk/plugin.h"

namespace nonio::rotary_chain {

/// The order of the axes in the kinematic chain, from the options.
struct Chain {
  std::vector<std::string>
      axes;  ///< tables from the bed outwards, then heads from the bed outwards
  std::size_t tables = 0;
  bool is_head(std::size_t axis) const { return axis >= tables; }
};

/// The centers of all measurements with angles of both axes and one reference point.
struct Places {
  std::vector<math::ChainReading> readings;  ///< sorted by measurement and time
  math::ChainOrder order;
  std::vector<const Observations*> tables;  ///< readings of each measurement in `used`
  std::vector<std::string> used, left_out;  ///< ids of measurements, each with its own ball
  std::vector<const Measurement*> tools;    ///< the first measurement of each tool
  double stated_u = 0.0;                    ///< u of a center from its file, m; 0 if not stated
  std::vector<Finding> findings;
  bool sound = true;
};

/// Readings of several runs or directions at one position of both axes become one center, weighted
/// by their number. A position repeated in one run and direction is a finding.
Places places_of(const AnalysisInput&, const Chain&);

/// Compares the state of the machine and the adjustment ("before" or "after").
bool same_state(const Measurement&, const Measurement&);

}  // namespace nonio::rotary_chain
