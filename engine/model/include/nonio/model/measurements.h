// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/fit.h"
#include "nonio/sdk/campaign.h"

/// What of a campaign is explained together, and the effects that can be in its model.
namespace nonio::model {

/// Time constant with which a linear axis grows while it is exercised: of the thermal tests of the
/// campaign. Of first-order heating it is all that such a test and runs of the axis share: not the
/// amplitude and not the state of warmth (docs/model.md).
struct TimeConstant {
  enum class State {
    known,
    none,          ///< no test gives one
    contradictory  ///< two tests give different ones
  };
  std::string axis;
  std::vector<std::string> measurements;  ///< that give it; of `none` all
  State state = State::none;
  double tau = 0.0, u = 0.0;  ///< s
};

/// Time constants differ from so many standard uncertainties of the difference of their logarithms
/// on (docs/dev/constants.md, M34).
inline constexpr double time_constants_apart = 2.6;

/// Measurements that are explained together: they sense the same axes in the same unit.
struct Part {
  enum class Kind {
    axis,   ///< runs of one axis, sensed along it
    space,  ///< several linear axes: their runs, straightness, diagonals, step diagonals
    balls,  ///< centres of a ball that turns with a rotary axis: radial and axial, m
    course  ///< a displacement over time, with channels that were recorded next to it
  };
  std::string name;                       ///< "X", "XY", "EYX", "C centres", "warm/x1"
  std::vector<std::string> measurements;  ///< ids
  std::vector<Axis> axes;                 ///< one of an axis or balls; else the linear ones
  Observations table;                     ///< lines named by their measurements
  Kind kind = Kind::axis;
  std::vector<std::uint32_t> measurement{};  ///< of each reading: index into `measurements`
  std::vector<std::uint32_t> row{};          ///< of each reading: row of its measurement's table
  std::vector<double> along{};               ///< of each reading: its place on its line, m or rad
  std::vector<std::int8_t> way{};            ///< of each reading: +1 or -1 along its line
  /// Measurements of an axis whose file cannot be in the order in which it was measured: the cycle
  /// of ISO 230-2 is assumed.
  std::vector<std::string> order_assumed{};
  std::vector<TimeConstant> time_constants{};  ///< of its axes
  /// By what the lines of an axis differ; none of a single measurement.
  std::vector<std::shared_ptr<const Grouping>> groupings{};

  // Of a course.
  std::string displacement{};   ///< its name
  std::size_t displacements{};  ///< how many the measurement has
  /// Displacements of the same measurement that move with this one, at the same times: m. Their
  /// effects are searched together; each has sizes of its own.
  std::vector<std::vector<double>> companions{};
  std::vector<std::string> companion_names{};
};

/// Which shape of an effect is the time constant of a growth: continuous, named "tau", a time, next to
/// one growth per length.
std::optional<std::size_t> time_constant_shape(const Effect& effect);
/// Whether a term has the value that another measurement states.
bool has_stated(const Term& term);

/// A reading for which the manifest does not state the position of the other axes.
inline bool has_unstated_position(const Part& part) {
  for (const auto& axis : part.table.axes)
    for (const double x : axis.position)
      if (!(x == x)) return true;
  return false;
}

/// What can be explained together, in the order of the measurements: runs of one axis; where
/// something is sensed across the axes or in several at once, all linear axes and their
/// measurements in one table; ball centres of a rotary axis. Others are left out, and so are
/// readings that `check` (sdk/check.h) refuses.
std::vector<Part> parts_of(const Campaign& campaign, const std::vector<Observations>& read);

/// All effects that apply to a part, without those that are always in a model; then those whose
/// values can differ between groups of lines.
std::vector<Term> catalogue(const Part& part, const std::vector<Effect>& effects);

/// The names that an effect has in this part: "backlash:X", "straightness:EYX".
std::vector<std::string> names_of(const Part& part, const Effect& effect);

/// An effect of the model as it is written for this part: of a course that is one of several
/// displacements "heat:t4/x1" or "heat:t4/x1+x2" ("only of these"), else its name.
std::string written_for(const Part& part, const std::string& effect);
/// Whether an effect as it is written is for this part, as far as it lists displacements.
bool is_for(const Part& part, const std::string& effect);

/// The effects that a model names, then those that are always there, then its descriptions; an
/// unknown kind, axis or grouping is an error. Effects of axes that other parts hold are left out,
/// and so is an effect that is also there with groups, which contain it.
Expected<std::vector<Term>> terms_of(const Part& part, const Machine& machine,
                                     const std::vector<std::string>& names,
                                     const std::vector<Effect>& effects);

}  // namespace nonio::model
