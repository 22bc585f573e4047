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

/// Functions shared by all writers of controller tables: find the axes, refuse errors that no table
/// can compensate, predict the deviations after compensation. Compiled into each plugin, because
/// plugins must not depend on each other.
namespace nonio::controllers {

/// Columns of a table: one for the mean of both directions, or one for each direction.
enum class Columns { mean, both };

/// A step of the curve between adjacent targets that does not exceed the resolution and the scatter
/// of the readings, but would make a table steep.
struct Unresolved {
  double from = 0.0, to = 0.0;      ///< positions of the two targets, m or rad
  double step = 0.0;                ///< size of the step, m or rad
  double resolution = 0.0;          ///< smallest difference of two readings, m or rad
  double slope = 0.0, limit = 0.0;  ///< slope of the step, and the limit that it exceeds; a ratio
};

/// A mean reversal whose U is at least half of it, so that no backlash value is derived from it.
struct HeldReversal {
  double mean = 0.0;       ///< m or rad
  bool attention = false;  ///< severity: the runs repeat it, or it may be a fifth of A
};

/// One measured axis for which a table is to be written. SI.
struct AxisJob {
  std::string axis, measurement;
  std::string stem;        ///< start of its file names; includes the measurement if an axis has two
  std::size_t number = 0;  ///< number of the axis in the control; 0: not stated
  bool rotary = false;
  math::ErrorCurve curve;  ///< curve to be compensated: as measured, or as the model predicts
  std::optional<math::ErrorCurve> measured;  ///< measured curve, if `curve` is the model's
  std::optional<math::ErrorCurve> turn;      ///< for a rotary axis measured over the whole turn
  bool from_diagonals = false;  ///< positioning from step diagonals: the reversal is not known
  /// false: `curve` is given minus its end-point line, because step diagonals alone do not
  /// determine the scale
  bool scale_known = true;
  math::Reversal reversal;
  AxisSettings settings;           ///< settings of this axis in option `axes`
  std::vector<std::string> drift;  ///< ids of the findings with severity warning
  std::optional<Unresolved> unresolved{};
  math::CompensatedUncertainty U;
  /// a mean reversal that is not known well enough; if set, `curve` is the mean in both directions
  std::optional<HeldReversal> held{};
  std::vector<std::string> suspects;  ///< suspect readings: "190.0 mm (3, +)"
  std::vector<std::string> about;     ///< header lines in plain ASCII: machine, axis, date

  /// Its tables as the control reads them back from the files; nothing if the table was refused.
  std::optional<std::vector<LoadedTable>> loaded{};

  const math::ErrorCurve& table_curve() const { return turn ? *turn : curve; }
  /// Returns the value of the control's backlash parameter while the axis was measured (setting
  /// `backlash`), m or rad.
  double present_backlash() const { return position_setting("backlash").value_or(0.0); }
  /// Returns the new value of the backlash parameter, positive for lost motion, m or rad. If a
  /// single value would leave a larger reversal somewhere than exists now, the present value is
  /// kept.
  double backlash() const {
    return one_value_helps() ? present_backlash() - curve.mean_reversal() : present_backlash();
  }
  /// Returns the measured mean reversal, whether the table contains it or not.
  double mean_reversal() const { return held ? held->mean : curve.mean_reversal(); }
  /// Whether the reversal is constant enough for a single value to compensate most of it;
  /// independent of the pitch table.
  bool one_value_helps() const;
  /// Whether the table of an axis that drifted was requested (setting `drifted`).
  bool takes_drift() const { return setting("drifted").value_or(0.0) != 0.0; }
  /// Returns printed units per SI unit: mm per m, or deg per rad.
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
  std::string_view unit() const { return rotary ? "deg" : "mm"; }
  /// Returns a setting of this axis that is a length or angle, in SI: "first" reads first_mm or
  /// first_deg.
  std::optional<double> position_setting(std::string_view name) const;
  std::optional<double> setting(std::string_view name) const;
};

/// Whether the campaign contains measurements for a pitch table: axis runs, or step diagonals.
bool has_tables(const Campaign&);

/// Returns the axis measurements with readings, in the campaign's order, and the positioning from
/// step diagonals for axes without them. `keys`: settings of one axis in option `axes`; "reference"
/// is reference_mm and reference_deg, a name that ends with ':' is a plain number. Findings and
/// notes are added to `result`.
Expected<std::vector<AxisJob>> axis_jobs(const ControllerInput& input,
                                         const std::vector<std::string_view>& keys,
                                         OutputResult& result);

/// Returns true, and adds a finding that names the key and the file, if the number of one of these
/// axes in the control is not stated.
bool lacks_number(const std::vector<std::string>& of, const ControllerInput& input,
                  const std::vector<KnownAxis>& axes, const std::string& measurement,
                  OutputResult& result);

/// Returns whether the active table and the active backlash value during the measurement are
/// stated; if not, adds a finding that names the missing keys. Otherwise a table of the remaining
/// errors would replace the table that had compensated the others.
bool states_active(const ControllerInput& input, const std::string& axis,
                   const std::string& measurement, bool backlash_in_options, OutputResult& result);

/// Returns a note about this axis; its text may use {axis} and {unit}.
Remark remark(const AxisJob& job, std::string id);

/// Returns the declaration of option `axes`, with the keys in its help.
Option axes_option(std::string keys);
/// Returns the options step_mm and step_deg.
std::vector<Option> step_options();
/// Returns the step for this axis from its settings or the options, m or rad; 0: not stated.
double wished_step(const AxisJob& job, const Settings& options);

/// Returns true, and adds a finding, if the reversal changes along the axis by as much as the pitch
/// table compensates, and no direction tables are requested.
bool refused(const AxisJob& job, Columns columns, OutputResult& result);

/// Returns warning lines for the table of an axis that was not stable while it was measured, or
/// that has suspect readings; empty otherwise.
std::vector<std::string> warnings(const AxisJob& job, OutputResult& result);
/// Returns text for the table's file that states how the reversal was treated.
std::string reversal_words(const AxisJob& job, Columns columns);

/// Adds findings about a single backlash value: the reversal varies along the axis; a single value
/// brings no gain; or the reversal is positive (over-travel) and the active compensation of the
/// control is not stated, so that the written value would replace one that should be reduced.
void doubt_backlash(const AxisJob& job, OutputResult& result);

/// Adds the predictions of E, B and M before and after compensation. `correction` is read back from
/// the bytes written and contains everything that the control adds; the present backlash value is
/// subtracted here. Adds a finding if the table makes the mean deviations worse.
void predict(const AxisJob& job, const math::Correction& correction, OutputResult& result);

/// Returns the position at which the entry of the table must be zero: the axis' setting
/// `reference`, else 0 if the table contains it, else its end nearest to 0.
double reference_position(const AxisJob& job, double first, double last);

/// Returns a position in the axis' unit, with the unit: "12.5 mm".
std::string with_unit(const AxisJob& job, double si, int decimals);
/// Returns a deviation with its unit: "8.143 um" or "1.2 arcsec".
std::string deviation_words(const AxisJob& job, double si);

}  // namespace nonio::controllers
