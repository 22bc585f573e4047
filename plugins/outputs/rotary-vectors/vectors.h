// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::rotary_vectors {

/// A rotary axis as an analysis gave it; SI.
struct Line {
  std::string measurement, axis;
  std::array<Value, 3> centre, direction;
  Value radius;
  std::vector<std::string> shares_reference;  ///< measurements it was compared with
  /// Of the fit of two axes together: the order of those that carry the workpiece, "B, C".
  bool of_chain = false;
  std::string tables{};
  bool head = false;  ///< as seen from the tip of the tool
};
/// Of an axis that is part of a fit of two together, that one alone.
std::vector<Line> lines_of(const Campaign&, const Results&);

/// In mm, or without a unit: as many digits as 0.1 um and 0.1 urad need.
std::string millimetres(double si);
std::string component(double value);
/// With spaces before it.
std::string padded(std::string text, std::size_t width);

/// What the user knows of the controls.
struct Wish {
  double limit = 2e-4;                  ///< largest change of a length, m
  std::vector<std::string> sign_shown;  ///< controls on which a move has shown the signs
  NumberTables before;                  ///< by control: what it has, mm
};

/// Files for controls whose parameters have known names, for a table C on a tilting axis A or B.
void write_controllers(const std::vector<Line>&, const std::string& campaign, const Wish&,
                       OutputResult&);

}  // namespace nonio::rotary_vectors
