// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "axis_job.h"
#include "nonio/math/compensation.h"
#include "nonio/sdk/plugin.h"

/// Tables that correct one axis from the position of another: straightness and squareness from
/// diagonals or step diagonals, on the points of their pitch.
namespace nonio::controllers {

/// Error of axis `output` over axis `input`, 0 at the first point. SI.
struct CrossCurve {
  std::string input, output;
  std::vector<double> position, value;
};

/// A line in space as it was read: what tables do to it can be predicted.
struct ReadLine {
  std::string name;                               ///< D1, PPP
  std::map<std::string, double> sense;            ///< unit vector, by axis
  std::vector<std::map<std::string, double>> at;  ///< position of each axis at each stop
  std::vector<double> deviation;
};

/// The curves of one evaluation: EYX over X, EXY with squareness over Y, and so on.
struct CrossJob {
  std::string measurement;        ///< the first one of the set
  std::vector<std::string> uses;  ///< measurements that the curves are made from
  std::vector<CrossCurve> curves;
  std::vector<ReadLine> lines;
  bool volume = false;  ///< of step diagonals: the pitch tables count in the prediction too

  /// X, Y, Z as far as they are in it, for names of files.
  std::string axes() const;
};

/// Of the analyses that could separate the straightnesses: what is not known has no table.
std::vector<CrossJob> cross_jobs(const OutputInput&);

/// Whether this pitch table and these curves are of one state of the machine.
bool together(const CrossJob&, const AxisJob&, const Campaign&);

/// What a control adds to axis `second` by the position of axis `first`.
using Corrections = std::map<std::pair<std::string, std::string>, math::Correction>;

/// Ranges of the lines before, and after with what the control adds; tables that make one of them
/// worse give a finding.
void predict_lines(const CrossJob&, const Corrections&, OutputResult& result);

}  // namespace nonio::controllers
