// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nonio/controllers/cross_job.h"

/// Joint effect of all tables of a run on the machine, parsed from the files that were written.
namespace nonio::controllers {

/// The beam of a gantry, which is rigid: a motion of one side is distributed along it.
///
///     share(y) = 1 - (y - y_axis)/(y_slave - y_axis)        of the axis; of the slave 1 - share
///     x moves by share c_axis + (1 - share) c_slave         m
///     the beam turns by (c_slave - c_axis)/(y_slave - y_axis)
///
/// y: position along the beam; those of the sides are where their lines were measured (`at`).
/// Source: statics of a rigid body.
struct Beam {
  std::string axis, slave;
  /// the axis along the beam; empty: the positions of the sides are not stated
  std::string along{};
  double at_axis = 0.0, at_slave = 0.0;
};

/// Returns a beam for each axis with a slave.
std::vector<Beam> beams_of(const Campaign&);

/// Adds yaw to the squareness. C0Y refers to the first stop, but the pitch tables of both sides
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
  /// An axis whose new table replaces one that was active while the diagonals were measured. The
  /// effect of the old table on them is not known, so nothing is predicted for them. Empty: there
  /// is none.
  std::string replaces{};

  /// Returns what is added to `axis` at this position, in excess of what was added while it was
  /// measured; nothing if that depends on the positions of a gantry's sides and they are not
  /// stated.
  std::optional<double> moved(const std::string& axis, std::map<std::string, double> at,
                              std::map<std::string, int> direction) const;
};

/// Returns the pitch tables that were written in this run and belong to the same state of the
/// machine as these curves.
Replay replay_of(const CrossJob&, const std::vector<AxisJob>& pitch, const ControllerInput&);

/// Adds the ranges of the lines before, and after with these tables; adds a finding if tables make
/// one of them worse.
void predict_lines(const CrossJob&, const Replay&, OutputResult& result);

/// Predicts the lines with the tables that `parse` returns for these files, and with the pitch
/// tables that were written. Error: a curve is not found in the files.
Expected<void> predict_cross(const CrossJob&, const std::vector<Artifact>&,
                             Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                             const std::vector<AxisJob>& pitch, const ControllerInput&,
                             OutputResult& result);

}  // namespace nonio::controllers
