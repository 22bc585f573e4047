// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/fit.h"
#include "nonio/sdk/campaign.h"

namespace nonio::model {

/// Time constant of the growth of a linear axis while it moves, from thermal tests. These have only
/// the time constant in common with the runs of the axis (docs/model.md).
struct TimeConstant {
  enum class State {
    known,
    none,          ///< no thermal test determines a time constant
    contradictory  ///< two tests determine significantly different time constants
  };
  std::string axis;
  std::vector<std::string> measurements;  ///< tests that determine it; for `none` all tests
  State state = State::none;
  double tau = 0.0, u = 0.0;  ///< time constant and its standard uncertainty, s
};

/// Two time constants are contradictory if their logarithms differ by more than this multiple of
/// the standard uncertainty of the difference (docs/dev/constants.md, M34).
inline constexpr double time_constants_apart = 2.6;

/// A recorded channel, or some of its values, that is not used.
struct ChannelLeft {
  enum class Why {
    partly,                ///< not recorded next to all measurements
    untimed,               ///< readings without a time
    speed,                 ///< a speed or load: only displacements over time determine its effects
    frozen,                ///< a thermometer that keeps one value while all others move
    start_value,           ///< a thermometer that often returns its value after power-on
    start_values_dropped,  ///< the same, but rarely: only these values are not used
    spikes_dropped         ///< single readings far from those around them, which are not used
  };
  std::string name;
  Why why = Why::partly;
  std::vector<std::string> measurements{};  ///< those that lack the channel, or times
  // The members below apply to a thermometer that fails.
  double value = 0.0;           ///< degC; of the largest spike
  std::size_t readings = 0;     ///< number of readings with this value, or of spikes
  double from = 0.0, to = 0.0;  ///< for `frozen`: time of the first and the last of them, s

  bool fails() const { return why == Why::frozen || why == Why::start_value; }
  bool lacks_readings() const { return why == Why::partly || why == Why::untimed; }
};

/// A gap in a displacement over time, in which its sensor may have been touched, or a jump of the
/// sensor. The readings after it have a zero, and so a line, of their own, and what the model leaves
/// of them is independent of that before it.
struct Restart {
  double from = 0.0, to = 0.0;  ///< times of the last reading before it and the first after it, s
  double jump = 0.0;            ///< change of the displacement, m; 0 for a gap
  std::string displacement{};   ///< that jumps; empty for a gap

  bool is_gap() const { return displacement.empty(); }
};

/// Measurements that are explained together: they sense the same axes in the same unit.
struct Part {
  enum class Kind {
    axis,   ///< runs of one axis, sensed along it
    space,  ///< several linear axes: their runs, straightness, diagonals, step diagonals
    balls,  ///< centers of a ball that turns with a rotary axis: radial and axial, m
    course  ///< a displacement over time, with recorded channels
  };
  std::string name;  ///< for example "X", "XY", "EYX", "warm/x1"
  std::vector<std::string> measurements;
  /// one for `axis` and `balls`, the linear axes for `space`; for `course` an axis that is only a
  /// name
  std::vector<Axis> axes;
  Observations table;  ///< readings of all measurements of the part
  Kind kind = Kind::axis;
  std::vector<std::uint32_t> measurement{};  ///< index into `measurements` of each reading
  /// row of each reading in its measurement's table; for `balls` that of the first coordinate
  std::vector<std::uint32_t> row{};
  /// place of each reading on its line, m or rad; for `course` its time, s
  std::vector<double> along{};
  /// direction of motion along the line, +1 or -1; 0 if it is not known, and for `course`
  std::vector<std::int8_t> way{};
  /// Measurements of an axis with an impossible order of rows: the cycle of ISO 230-2 is assumed.
  std::vector<std::string> order_assumed{};
  std::vector<TimeConstant> time_constants{};  ///< of the axes, from thermal tests
  /// Groupings of the lines of an axis; empty for a single measurement.
  std::vector<std::shared_ptr<const Grouping>> groupings{};

  std::vector<ChannelLeft> channels_left{};  ///< channels without effects

  // The members below apply to a course.
  std::string displacement{};   ///< name of the displacement, such as "x1"
  std::size_t displacements{};  ///< number of displacements of the measurement
  /// Displacements that move together with this one, m; each has parameters of its own.
  std::vector<std::vector<double>> companions{};
  std::vector<std::string> companion_names{};
  /// Of this displacement and its companions, in the order of time.
  std::vector<Restart> restarts{};
};

/// Index of the shape that is the time constant of a growth: continuous, named "tau", a time, in an
/// effect with one linear parameter, a growth per length.
std::optional<std::size_t> time_constant_shape(const Effect& effect);
/// Whether the term uses the value of a shape that another measurement states.
bool has_stated(const Term& term);

/// Names of the measurements with an axis position that the manifest does not state (NaN).
std::vector<std::string> unstated_positions(const Part& part);

/// Parts in the order of their first measurements. If the campaign has diagonals, each state of the
/// machine has one part in space, which contains the runs of its axes; otherwise one for each axis
/// and direction of sensing. Other measurements and those rejected by `check` are omitted.
std::vector<Part> parts_of(const Campaign& campaign, const std::vector<Observations>& read);

/// Effects that apply to a part, except nuisances, followed by the grouped terms of effects whose
/// values can differ between groups of lines.
std::vector<Term> catalogue(const Part& part, const std::vector<Effect>& effects);

/// Returns the names of an effect in this part: "backlash:X", "straightness:EYX".
std::vector<std::string> names_of(const Part& part, const Effect& effect);

/// Effect as the manifest writes it for this part, with its displacements if the measurement has
/// others that do not move together with them: "heat:t4/x1", "heat:t4/x1+x2".
std::string written_for(const Part& part, const std::string& effect);
/// False if `effect` lists displacements after "/" without that of this part, which is a course.
bool is_for(const Part& part, const std::string& effect);

/// Terms of the named effects, then the nuisances, then the descriptions. Errors: an unknown kind,
/// axis or grouping, or an effect that does not apply to the readings. Effects that cannot occur in
/// this part are omitted, and so is an effect that the model also has with groups.
Expected<std::vector<Term>> terms_of(const Part& part, const Machine& machine,
                                     const std::vector<std::string>& names,
                                     const std::vector<Effect>& effects);

}  // namespace nonio::model
