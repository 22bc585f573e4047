// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
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
  bool told = false;       ///< it is stated; else 0 if the axis has it, else its nearest end
  std::string
      side_of{};  ///< where `output` is the second side of a gantry: the axis that it follows
};

/// What a control does with the second side of a gantry, where a table moves the first one.
enum class SecondSide {
  own_table,    ///< nothing: compensation is entered for each side, so both get the table
  moves_along,  ///< the same: these tables change the position that is commanded
  not_known,    ///< the maker does not state it: no table is written
};

/// A line in space as it was read: what tables do to it can be predicted.
struct ReadLine {
  std::string name;                               ///< D1, PPP
  std::map<std::string, double> sense;            ///< unit vector, by axis
  std::vector<std::map<std::string, double>> at;  ///< position of each axis at each stop
  std::vector<double> deviation;
  std::vector<int> ways{1,
                        -1};  ///< read along `sense`, against it: `deviation` is the mean of these
};

/// The squareness as a shift of the zero of a gantry's second side, in place of a part of a table: at the same command
/// that side is `shift` further towards plus.
struct SlaveZero {
  std::string axis, slave, along;        ///< along: the axis of the beam
  double at_axis = 0.0, at_slave = 0.0;  ///< where the sides are along the beam, m
  double shift = 0.0;                    ///< m
};

/// The curves of one evaluation: EYX over X, EXY with squareness over Y, and so on.
struct CrossJob {
  std::string measurement;        ///< the first one of the set
  std::vector<std::string> uses;  ///< measurements that the curves are made from
  std::vector<CrossCurve> curves;
  std::vector<ReadLine> lines;
  bool volume = false;  ///< of step diagonals
  /// Two diagonals alone: the curves are the even parts of the straightnesses. Size of what is in no table, q_odd.
  std::optional<double> odd_left{};
  std::optional<SlaveZero> slave_zero{};  ///< where option squareness is "slave-zero"
  double yaw_at_reference =
      0.0;  ///< rad, in the squareness: the beam of a gantry where its pitch tables are zero

  /// X, Y, Z as far as they are in it, for names of files; a gantry's second side goes with its axis.
  std::string axes() const;
  /// Axes that the tables move, each once.
  std::vector<std::string> outputs() const;
  /// Every axis that a curve is of or over.
  std::vector<std::string> moving() const;
};

/// From the analyses: a curve that is not known gives no table. On a gantry each side has its
/// curve, or a finding states why there is no table.
std::vector<CrossJob> cross_jobs(const ControllerInput&, SecondSide, OutputResult& result);

/// A finding: no such table on a gantry, because the motion of the second side is not known.
void refuse_second_side(const Axis&, const std::string& measurement, OutputResult& result);

/// Option squareness: where the squareness of a gantry goes.
Option squareness_option();

/// Whether this pitch table and these curves are of one state of the machine.
bool together(const CrossJob&, const AxisJob&, const Campaign&);

/// True, with findings, where a curve is larger or steeper than the maker of the machine allows a
/// table of its output axis: settings largest_um and slope_um_per_m.
bool oversized(const CrossJob&, const ControllerInput&, OutputResult&);

/// Of the whole set, for the file: what is in no table, what the squareness is of. Also as notes.
std::vector<std::string> set_words(const CrossJob&);

/// "Y over X: zero at 0.0 mm of X, largest entry ...", for the file; and the same as notes.
std::string cross_words(const CrossCurve&);
void note_cross(const CrossJob&, OutputResult&);

/// More points than option `max_points` allows are an error.
Expected<void> fits(const CrossJob&, const Settings& options);

}  // namespace nonio::controllers
