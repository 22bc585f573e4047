// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/cross_job.h"

/// What the tables of a run do to the machine together: those of every axis, on both sides of a gantry, read from
/// the text that was written.
namespace nonio::controllers {

/// The beam of a gantry, which is rigid: what one side alone moves is shared out along it.
///
///     share(y) = 1 - (y - y_axis)/(y_slave - y_axis)          of the axis; of the slave 1 - share
///     x moves by share c_axis + (1 - share) c_slave            m; the beam turns by (c_slave - c_axis)/(y_slave - y_axis)
///
/// y: position along the beam, of the sides as their lines were measured (`at`). Source: statics of a rigid body.
struct Beam {
  std::string axis, slave;
  std::string along{};  ///< the axis along the beam; empty: the places of the sides are not stated
  double at_axis = 0.0, at_slave = 0.0;
};

/// A beam for each axis with a slave.
std::vector<Beam> beams_of(const Campaign&);

/// The pitch tables of both sides hold the beam as it is where they are zero. C0Y is that of the
/// first stop, so the yaw between both places is added to what the cross table takes.
void turn_to_reference(const ControllerInput&, CrossJob&, const NumberTables& settings);

/// The squareness of these curves, C0Y, becomes a shift of the zero of the second side, with that yaw. False where there
/// is no gantry among the axes, or the places of its sides are not stated (`at`).
bool shift_slave(const ControllerInput&, CrossJob&, double C0Y, const NumberTables& settings);

/// Tables in the control.
struct Replay {
  std::vector<LoadedTable> tables;
  std::vector<Beam> beams{};                 ///< of a control whose tables move one side each
  std::map<std::string, double> backlash{};  ///< parameter while measured, by axis
  std::map<std::string, double> shift{};     ///< of the zero of an axis, m
  /// An axis whose new table takes the place of one that was active while the diagonals were read: what that did to
  /// them is not known here, so nothing is predicted of them. Empty: there is none.
  std::string replaces{};

  /// What is added to `axis` at this place, more than was while it was measured; nothing where that depends on the
  /// places of a gantry's sides and they are not stated.
  std::optional<double> moved(const std::string& axis, std::map<std::string, double> at,
                              std::map<std::string, int> direction) const;
};

/// Pitch tables that were written in this run and belong to the state of the machine that these curves are of.
Replay replay_of(const CrossJob&, const std::vector<AxisJob>& pitch, const ControllerInput&);

/// Ranges of the lines before, and after with these tables; tables that make one of them worse give a finding.
void predict_lines(const CrossJob&, const Replay&, OutputResult& result);

/// The same with what `parse` makes of these files, and with the pitch tables that were written. An error where a
/// curve is not found in the files.
Expected<void> predict_cross(const CrossJob&, const std::vector<Artifact>&,
                             Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                             const std::vector<AxisJob>& pitch, const ControllerInput&,
                             OutputResult& result);

}  // namespace nonio::controllers
