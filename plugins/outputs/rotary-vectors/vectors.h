// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::rotary_vectors {

/// A rotary axis as determined by an analysis; SI.
struct Line {
  std::string measurement, axis;
  std::array<Value, 3> centre, direction;
  Value radius;
  std::vector<std::string> shares_reference;  ///< measurements with which it was compared
  /// If two axes were fitted together: those that carry the workpiece, in order: "B, C".
  bool of_chain = false;
  std::string tables{};
  bool head = false;  ///< the axis carries the tool; coordinates relative to its tip
};
/// All rotary axes with a result; two axes that were fitted together are two lines.
std::vector<Line> lines_of(const Campaign&, const Results&);

/// Fixed decimals for a resolution of 0.1 um and 0.1 urad.
std::string millimetres(double si);
std::string component(double value);
/// Right-aligned in `width` characters.
std::string padded(std::string text, std::size_t width);

/// Data of the controls from the options.
struct Wish {
  double limit = 2e-4;                  ///< largest change of a length, m
  std::vector<std::string> sign_shown;  ///< controls whose signs were verified by a motion
  NumberTables before;                  ///< by control: present parameters, mm
};

/// Writes files for controls with known parameter names, for a table C on a tilting axis A or B.
void write_controllers(const std::vector<Line>&, const std::string& campaign, const Wish&,
                       OutputResult&);

}  // namespace nonio::rotary_vectors
