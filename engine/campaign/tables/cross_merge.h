// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"

/// The tables of several axes together in a backup: pitch of each, and of one by the position of
/// another (straightness and squareness from diagonals).
namespace nonio::tables {

/// Returns the axes that a text such as "XY" names, and their slaves; empty if it is the name of
/// one axis, or if a letter is no linear axis of the machine.
std::vector<std::string> set_of_axes(const std::string& text, const Machine& machine);

/// Range of the mean deviation along a diagonal, as measured, and with all tables of the files, m.
struct LineForecast {
  std::string measurement;
  double before = 0.0, after = 0.0;
};

/// A control's backup in which the tables of a set of axes are replaced.
struct MergedSet {
  std::vector<Artifact> files;  ///< complete text of the changed files; none: refused
  std::vector<Artifact> whole;  ///< all files that contain tables afterwards
  std::vector<TableDifference> differences;
  std::vector<TableForecast> forecast;       ///< of the runs of the axes
  std::vector<LineForecast> lines;           ///< of the diagonals
  std::map<std::string, MeasuredWith> with;  ///< state of each axis during the measurement
  std::vector<LoadedTable> next;             ///< all tables after the merge
  std::vector<Finding> findings;
};

/// Replaces the tables of the axes `set` in a backup. `results`: the analyses of the readings as
/// measured. An error if it is not known what was active, if the campaign determines no table of
/// one axis by another, or if another table would change.
Expected<MergedSet> merge_set(const reading::ReadCampaign& read, const Results& results,
                              const Controller& controller, const Settings& options,
                              const std::vector<Artifact>& backup,
                              const std::vector<std::string>& set);

/// A diagonal before and after loading: ranges as measured and as predicted, and the expanded
/// uncertainty of the range after loading (k = 2; 0: not known), m.
struct LineVerdict {
  std::string measurement;
  double before = 0.0, predicted = 0.0, after = 0.0, U = 0.0;
  bool worked() const { return after <= predicted + U && after < before; }
  bool failed() const { return after > predicted + U && after >= before; }
};
/// Compares the predicted diagonals with those of a campaign after loading that have the same ends.
std::vector<LineVerdict> judge_lines(const MergedSet& merged, const reading::ReadCampaign& before,
                                     const reading::ReadCampaign& after,
                                     const std::vector<std::string>& set);

/// Whether these tables of the set are in the control: equal to those of the files, m or rad.
bool are_loaded(const std::vector<LoadedTable>& in_control, const MergedSet& merged,
                const std::vector<std::string>& set);

}  // namespace nonio::tables
