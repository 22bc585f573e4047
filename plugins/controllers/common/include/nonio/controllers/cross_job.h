// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "nonio/controllers/axis_job.h"
#include "nonio/math/compensation.h"
#include "nonio/sdk/plugin.h"

/// Tables that correct one axis from the position of another: straightness and squareness from
/// diagonals or step diagonals, on the points of their pitch.
namespace nonio::controllers {

/// Error of axis `output` over axis `input`, 0 at the reference point of `input` as in all tables.
/// SI.
struct CrossCurve {
  std::string input, output;
  std::vector<double> position, value;
  double reference = 0.0;  ///< position of `input` where it is 0
  bool told = false;       ///< somebody says so; else 0 if it has it, else its nearest end
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
  /// Every axis that a curve is of or over.
  std::vector<std::string> moving() const;
};

/// Of the analyses that could separate the straightnesses: what is not known has no table.
std::vector<CrossJob> cross_jobs(const ControllerInput&);

/// Whether this pitch table and these curves are of one state of the machine.
bool together(const CrossJob&, const AxisJob&, const Campaign&);

/// True, with findings, where a curve is larger or steeper than the maker of the machine allows a
/// table of its output axis: settings largest_um and slope_um_per_m.
bool oversized(const CrossJob&, const ControllerInput&, OutputResult&);

/// "Y over X: zero at 0.0 mm of X, largest entry ...", for the file; and the same as notes.
std::string cross_words(const CrossCurve&);
void note_cross(const CrossJob&, OutputResult&);

/// More points than option `max_points` allows are an error.
Expected<void> fits(const CrossJob&, const Settings& options);

/// Ranges of the lines before, and after with these tables; tables that make one of them worse
/// give a finding.
void predict_lines(const CrossJob&, const std::vector<LoadedTable>&, OutputResult& result);

/// The same with what `parse` makes of these files, and of a volume with the pitch tables beside
/// them. An error where a curve is not found in the files.
Expected<void> predict_cross(const CrossJob&, const std::vector<Artifact>&,
                             Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                             const std::vector<AxisJob>& pitch, const ControllerInput&,
                             OutputResult& result);

}  // namespace nonio::controllers
