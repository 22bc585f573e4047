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
/// diagonals or step diagonals.
namespace nonio::controllers {

/// Error of axis `output` over the position of axis `input`, SI; 0 at the reference point of
/// `input`.
struct CrossCurve {
  std::string input, output;
  std::vector<double> position, value;
  double reference = 0.0;
  /// Whether the reference is stated; otherwise it is 0 if the axis has this position, or the
  /// nearest end.
  bool told = false;
  std::string side_of{};  ///< if `output` is the second side of a gantry: the axis that it follows
};

/// Effect of a table of the first side of a gantry on its second side.
enum class SecondSide {
  own_table,    ///< compensation is entered for each side, so both get the table
  moves_along,  ///< the second side follows, because the table changes the commanded position
  not_known,    ///< the maker does not document it, so no table is written
};

/// A measured line in space for which the effect of tables can be predicted.
struct ReadLine {
  std::string name;                               ///< D1, PPP
  std::map<std::string, double> sense;            ///< direction of sensing, unit vector, by axis
  std::vector<std::map<std::string, double>> at;  ///< position of each axis at each target
  std::vector<double> deviation;
  /// Directions of travel, along `sense` (1) or against it (-1); `deviation` is the mean over them.
  std::vector<int> ways{1, -1};
  double U = 0.0;  ///< expanded uncertainty of the range of `deviation`, m; 0: not known
  /// deviations as measured, if tables that were active then are removed from `deviation`
  std::vector<double> measured{};
};

/// Squareness compensated by a shift of the zero of a gantry's second side instead of a table: for
/// the same command that side is `shift` further towards plus.
struct SlaveZero {
  std::string axis, slave, along;        ///< `along` is the axis along the beam
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
  /// With two diagonals alone, the curves are only the even parts of the straightnesses; this is
  /// the size of the odd part q_odd, m.
  std::optional<double> odd_left{};
  std::optional<SlaveZero> slave_zero{};  ///< set if option squareness is "slave-zero"
  /// Part of the squareness: yaw of a gantry's beam at the position where its pitch tables are
  /// zero, rad.
  double yaw_at_reference = 0.0;

  /// The axes X, Y, Z that occur, for file names; the second side of a gantry is included in its
  /// axis.
  std::string axes() const;
  std::vector<std::string> outputs() const;
  std::vector<std::string> moving() const;
};

/// A curve that is not determined gives no table. On a gantry each side has its curve; otherwise a
/// finding states why there is no table.
std::vector<CrossJob> cross_jobs(const ControllerInput&, SecondSide, OutputResult& result);

/// Adds a finding that no cross table is written for a gantry, because the motion of its second
/// side is not known.
void refuse_second_side(const Axis&, const std::string& measurement, OutputResult& result);

/// Selects how the squareness of a gantry is compensated.
Option squareness_option();

/// Whether this pitch table and these curves are from the same state of the machine.
bool together(const CrossJob&, const AxisJob&, const Campaign&);

/// Returns true, with findings, if a curve exceeds the limits of the machine's maker for its output
/// axis: settings largest_um and slope_um_per_m.
bool oversized(const CrossJob&, const ControllerInput&, OutputResult&);

/// Lines for the file: errors that no table contains, and the source of the squareness; also added
/// as notes.
std::vector<std::string> set_words(const CrossJob&);

/// "Y over X: zero at 0.0 mm of X, largest entry ..." of the entries at these positions, which are
/// multiples of `step`. `note_cross` adds the same as notes, from the tables that were read back.
std::string cross_words(const CrossCurve&, double step, const std::vector<double>& at);
void note_cross(const CrossJob&, const std::vector<LoadedTable>& tables, OutputResult&);

/// An error if there are more points than option `max_points` allows.
Expected<void> fits(const CrossJob&, const Settings& options);

}  // namespace nonio::controllers
