// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/controllers/axes.h"
#include "nonio/math/compensated.h"
#include "nonio/math/compensation.h"
#include "nonio/math/reversal.h"
#include "nonio/sdk/plugin.h"

/// What every writer of controller tables does alike: find the axes, refuse what no table can
/// correct, predict what is left. Compiled into each plugin; a plugin uses no part of another.
namespace nonio::controllers {

/// The columns of a table: one of the mean of both directions, or one for each direction.
enum class Columns { mean, both };

/// A step of the curve between neighbouring targets that is not larger than the resolution of the
/// readings and their scatter, and that a table would make steep.
struct Unresolved {
  double from = 0.0, to = 0.0;      ///< positions, m or rad
  double step = 0.0;                ///< m or rad
  double resolution = 0.0;          ///< smallest difference of two readings, m or rad
  double slope = 0.0, limit = 0.0;  ///< of the step, and what it exceeds; a ratio
};

/// A mean reversal of which U is half or more: no value is made of it.
struct HeldReversal {
  double mean = 0.0;       ///< m or rad
  bool attention = false;  ///< the runs repeat it, or it may be a fifth of A
};

/// One measured axis of which a table is to be written. SI.
struct AxisJob {
  std::string axis, measurement;
  std::string stem;        ///< of file names; with the measurement where an axis has two of them
  std::size_t number = 0;  ///< in the control; 0: not stated
  bool rotary = false;
  math::ErrorCurve curve;                    ///< to be compensated: as measured, or the model's
  std::optional<math::ErrorCurve> measured;  ///< as measured, where `curve` is the model's
  std::optional<math::ErrorCurve> turn;      ///< of a rotary axis measured over the whole turn
  bool from_diagonals = false;  ///< positioning from step diagonals: nothing is known of reversal
  bool scale_known =
      true;  ///< false: `curve` is less its end line, as step diagonals alone know it
  math::Reversal reversal;
  AxisSettings settings;           ///< of this axis: option `axes`
  std::vector<std::string> drift;  ///< ids of the findings with severity warning
  std::optional<Unresolved> unresolved{};
  math::CompensatedUncertainty U;
  std::optional<HeldReversal> held{};  ///< `curve` is the mean in both directions then
  std::vector<std::string> suspects;   ///< readings: "190.0 mm (3, +)"
  std::vector<std::string> about;      ///< machine, axis, date: plain ASCII lines

  /// What its files are to the control once they are loaded; nothing where it was refused.
  std::optional<std::vector<LoadedTable>> loaded{};

  const math::ErrorCurve& table_curve() const { return turn ? *turn : curve; }
  /// What the control's backlash parameter held while the axis was measured; setting `backlash`.
  double present_backlash() const { return position_setting("backlash").value_or(0.0); }
  /// What goes into it now: positive for lost motion. One value that would leave a larger reversal
  /// somewhere than there is now is no gain: then it stays as it was.
  double backlash() const {
    return one_value_helps() ? present_backlash() - curve.mean_reversal() : present_backlash();
  }
  /// As measured, whether the table contains it or not.
  double mean_reversal() const { return held ? held->mean : curve.mean_reversal(); }
  /// Decided apart from the pitch: the reversal is constant enough that one value takes most of it.
  bool one_value_helps() const;
  /// The table of an axis that drifted was requested: setting `drifted`.
  bool takes_drift() const { return setting("drifted").value_or(0.0) != 0.0; }
  /// Printed units per SI: mm per m, or deg per rad.
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
  std::string_view unit() const { return rotary ? "deg" : "mm"; }
  /// A length or angle of this axis' settings in SI: "first" reads first_mm or first_deg.
  std::optional<double> position_setting(std::string_view name) const;
  std::optional<double> setting(std::string_view name) const;
};

/// Something of which there may be a pitch table: axis runs, or step diagonals.
bool has_tables(const Campaign&);

/// The axis measurements with readings, in the campaign's order, and what step diagonals know of
/// axes without them. `keys` are the settings that
/// option `axes` takes for one axis: "reference" is reference_mm and reference_deg, a
/// name with ':' at its end for a plain number. Findings and notes go to `result`.
Expected<std::vector<AxisJob>> axis_jobs(const ControllerInput& input,
                                         const std::vector<std::string_view>& keys,
                                         OutputResult& result);

/// True, with a finding that names the key and the file, if the number of one of these axes in the
/// control is not stated.
bool lacks_number(const std::vector<std::string>& of, const ControllerInput& input,
                  const std::vector<KnownAxis>& axes, const std::string& measurement,
                  OutputResult& result);

/// False, with a finding that names the missing keys, unless it is stated which table and which
/// backlash value were active while the axis was measured: a table of what remained would be loaded
/// in place of the table that had corrected the rest.
bool states_active(const ControllerInput& input, const std::string& axis,
                   const std::string& measurement, bool backlash_in_options, OutputResult& result);

/// A note about this axis; its words find {axis} and {unit}.
Remark remark(const AxisJob& job, std::string id);

/// The declaration of that option, with the keys in its help.
Option axes_option(std::string keys);
/// step_mm and step_deg.
std::vector<Option> step_options();
/// The step for this axis from its settings or the options; 0: not stated.
double wished_step(const AxisJob& job, const Settings& options);

/// True, with a finding, where the reversal changes along the axis by as much as the pitch table
/// compensates, and no direction tables are requested.
bool refused(const AxisJob& job, Columns columns, OutputResult& result);

/// Lines for a table of an axis that was not stable while it was measured, or of readings that
/// do not belong to the others; empty otherwise.
std::vector<std::string> warnings(const AxisJob& job, OutputResult& result);
/// How the reversal was treated, for the text that goes with a table.
std::string reversal_words(const AxisJob& job, Columns columns);

/// For a single backlash value. A finding if the axis moves too far at reversal and the active
/// compensation of the control is not stated: the value written then replaces one that it should
/// have lowered. Another one where the reversal varies and the value leaves much of it.
void doubt_backlash(const AxisJob& job, OutputResult& result);

/// E, B and M before and after, the latter with `correction` as read back from the bytes written;
/// it is the whole of what the control adds, the present backlash value is taken off here.
/// A table that makes the mean deviations worse gives a finding.
void predict(const AxisJob& job, const math::Correction& correction, OutputResult& result);

/// Where the entry of the table is to be zero: the axis' setting `reference`, else 0 if the
/// table has it, else its nearest end.
double reference_position(const AxisJob& job, double first, double last);

/// In the axis' unit with it: "12.5 mm".
std::string with_unit(const AxisJob& job, double si, int decimals);
/// "8.143 um" or "1.2 arcsec".
std::string deviation_words(const AxisJob& job, double si);

}  // namespace nonio::controllers
