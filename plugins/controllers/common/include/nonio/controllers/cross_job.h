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

/// Tables that compensate one axis by the position of another: straightness and squareness from
/// diagonals or step diagonals, at the points of their pitch.
namespace nonio::controllers {

/// Error of axis `output` over the position of axis `input`, 0 at the reference point of `input` as
/// in all tables. SI.
struct CrossCurve {
  std::string input, output;
  std::vector<double> position, value;
  double reference = 0.0;  ///< position of `input` at which the error is 0
  /// whether the reference is stated; if not, it is 0 if the axis has this position, else its
  /// nearest end
  bool told = false;
  std::string side_of{};  ///< if `output` is the second side of a gantry: the axis that it follows
};

/// Effect of a table of the first side of a gantry on its second side.
enum class SecondSide {
  own_table,    ///< none: compensation is entered for each side, so both get the table
  moves_along,  ///< the second side moves along, because the table changes the commanded position
  not_known,    ///< the maker does not state it: no table is written
};

/// A measured line in space, for which the effect of tables can be predicted.
struct ReadLine {
  std::string name;                               ///< name of the line: D1, PPP
  std::map<std::string, double> sense;            ///< direction of sensing, unit vector, by axis
  std::vector<std::map<std::string, double>> at;  ///< position of each axis at each stop
  std::vector<double> deviation;
  /// directions of reading, along `sense` (1) or against it (-1); `deviation` is the mean over them
  std::vector<int> ways{1, -1};
  double U = 0.0;  ///< expanded uncertainty of the range of `deviation`, m; 0: not known
  /// deviations as measured, if tables that were active then are removed from `deviation`
  std::vector<double> measured{};
};

/// Squareness as a shift of the zero of a gantry's second side, instead of a table: at the same
/// command that side is `shift` further towards plus.
struct SlaveZero {
  std::string axis, slave, along;        ///< along: axis along the beam
  double at_axis = 0.0, at_slave = 0.0;  ///< positions of the sides along the beam, m
  double shift = 0.0;                    ///< m
};

/// The curves of one evaluation: EYX over X, EXY with squareness over Y, and so on.
struct CrossJob {
  std::string measurement;        ///< first measurement of the set
  std::vector<std::string> uses;  ///< measurements from which the curves are computed
  std::vector<CrossCurve> curves;
  std::vector<ReadLine> lines;
  bool volume = false;  ///< whether the curves are from step diagonals
  /// With two diagonals alone, the curves are the even parts of the straightnesses; size of the odd
  /// part q_odd, which no table contains, m.
  std::optional<double> odd_left{};
  std::optional<SlaveZero> slave_zero{};  ///< set if option squareness is "slave-zero"
  /// rad, contained in the squareness: yaw of a gantry's beam at the position where its pitch
  /// tables are zero
  double yaw_at_reference = 0.0;

  /// Returns the axes X, Y, Z that occur, for names of files; a gantry's second side is included in
  /// its axis.
  std::string axes() const;
  /// Returns the axes that the tables move, each once.
  std::vector<std::string> outputs() const;
  /// Returns every axis that is the input or output of a curve.
  std::vector<std::string> moving() const;
};

/// Returns the jobs from the analyses; a curve that is not determined gives no table. On a gantry
/// each side has its curve; if it has not, a finding states why there is no table.
std::vector<CrossJob> cross_jobs(const ControllerInput&, SecondSide, OutputResult& result);

/// Adds a finding that no cross table is written for a gantry, because the motion of its second
/// side is not known.
void refuse_second_side(const Axis&, const std::string& measurement, OutputResult& result);

/// Returns option squareness, which selects how the squareness of a gantry is compensated.
Option squareness_option();

/// Whether this pitch table and these curves belong to the same state of the machine.
bool together(const CrossJob&, const AxisJob&, const Campaign&);

/// Returns true, and adds findings, if a curve is larger or steeper than the maker of the machine
/// allows for a table of its output axis: settings largest_um and slope_um_per_m.
bool oversized(const CrossJob&, const ControllerInput&, OutputResult&);

/// Returns lines about the whole set for the file: errors that no table contains, source of the
/// squareness. They are also added as notes.
std::vector<std::string> set_words(const CrossJob&);

/// `cross_words` returns a line about a curve for the file: "Y over X: zero at 0.0 mm of X, largest
/// entry ..."; `note_cross` adds the same as notes.
std::string cross_words(const CrossCurve&);
void note_cross(const CrossJob&, OutputResult&);

/// Error if there are more points than option `max_points` allows.
Expected<void> fits(const CrossJob&, const Settings& options);

}  // namespace nonio::controllers
