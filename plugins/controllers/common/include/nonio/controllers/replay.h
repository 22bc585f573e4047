// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/cross_job.h"

/// Joint effect of all tables of a run on the machine, parsed from the written files.
namespace nonio::controllers {

/// The rigid beam of a gantry: a motion of one side is distributed along it.
///
///     share(y) = 1 - (y - y_axis)/(y_slave - y_axis)        of the axis; of the slave 1 - share
///     x moves by share c_axis + (1 - share) c_slave         m
///     the beam rotates by (c_slave - c_axis)/(y_slave - y_axis)
///
/// y: position along the beam; the sides are at the positions of their measured lines (`at`).
/// Source: statics of a rigid body.
struct Beam {
  std::string axis, slave;
  /// The axis along the beam; empty if the positions of the sides are not stated.
  std::string along{};
  double at_axis = 0.0, at_slave = 0.0;
};

std::vector<Beam> beams_of(const Campaign&);

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
  std::vector<Beam> beams{};                 ///< beams of a control whose tables move one side each
  std::map<std::string, double> backlash{};  ///< backlash parameter during the measurement, by axis
  std::map<std::string, double> shift{};     ///< shift of the zero of an axis, m
  /// An axis whose new table replaces one that was active while the diagonals were measured, or
  /// empty. Nothing is predicted for the diagonals then, because the effect of the old table on
  /// them is not known.
  std::string replaces{};

  /// Value added to `axis` at this position, in excess of the value added during its measurement.
  /// None if it depends on the positions of a gantry's sides and they are not stated.
  std::optional<double> moved(const std::string& axis, std::map<std::string, double> at,
                              std::map<std::string, int> direction) const;
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
