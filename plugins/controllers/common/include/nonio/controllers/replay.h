// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/cross_job.h"
#include "nonio/math/beam.h"

/// Joint effect of all tables of a run on the machine, parsed from the written files.
namespace nonio::controllers {

/// Adds yaw to the squareness: C0Y refers to the first target, but the pitch tables of both sides
/// leave the beam unchanged where they are zero. The yaw between both positions is added to the
/// cross table.
void turn_to_reference(const ControllerInput&, CrossJob&, const NumberTables& settings);

/// Converts the squareness of these curves, C0Y minus the yaw that `turn_to_reference` adds, to a
/// shift of the zero of the second side. False if there is no gantry among the axes, or if the
/// positions of its sides are not stated (`at`).
bool shift_slave(const ControllerInput&, CrossJob&, double C0Y, const NumberTables& settings);

/// New tables of the control, and the compensation that they replace.
struct Replay {
  std::vector<LoadedTable> tables;
  std::vector<math::Beam> beams{};           ///< beams of a control whose tables move one side each
  std::map<std::string, double> backlash{};  ///< backlash parameter during the measurement, by axis
  std::map<std::string, double> shift{};     ///< shift of the zero of an axis, m
  /// An axis whose new table replaces one that was active while the diagonals were measured. They
  /// are predicted only if `ReadLine::measured` states that it was removed from them. Empty: there
  /// is none.
  std::string replaces{};

  /// Returns what is added to `axis` at this position, in excess of what was added while it was
  /// measured; nothing if that depends on the positions of a gantry's sides and they are not
  /// stated.
  std::optional<double> moved(const std::string& axis, const math::Places& at,
                              const math::MotionSigns& direction) const;
};

/// The replay contains the pitch tables of this run for the same state of the machine as the
/// curves.
Replay replay_of(const CrossJob&, const std::vector<AxisJob>& pitch, const ControllerInput&);

/// Adds the ranges of the lines before compensation and with these tables, and a finding if a line
/// becomes worse.
void predict_lines(const CrossJob&, const Replay&, OutputResult& result);

/// Predicts the lines with the tables that `parse` returns for these files, and with the written
/// pitch tables. Error: a curve is not found in the files.
Expected<void> predict_cross(const CrossJob&, const std::vector<Artifact>&,
                             Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                             const std::vector<AxisJob>& pitch, const ControllerInput&,
                             OutputResult& result);

}  // namespace nonio::controllers
