// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::vectors {

/// A rotary axis as an analysis gave it; SI.
struct Line {
  std::string measurement, axis;
  std::array<Value, 3> centre, direction;
  Value radius;
  std::vector<std::string> shares_reference;  ///< measurements it was compared with
};
std::vector<Line> lines_of(const Campaign&, const Results&);

/// In mm, or without a unit: as many digits as stand for 0.1 um and 0.1 urad.
std::string millimetres(double si);
std::string component(double value);

/// Files for controls whose parameters have known names, for a table C on a tilting axis A or B.
void write_controllers(const std::vector<Line>&, const std::string& campaign, OutputResult&);

}  // namespace nonio::vectors
