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

/// Functions for all writers of controller tables: finding the axes, refusing errors that no table
/// can compensate, predicting the remaining deviations. They are compiled into each plugin, because
/// plugins must not depend on each other.
namespace nonio::controllers {

/// A table of the mean of both directions, or a table for each direction.
enum class Columns { mean, both };

/// A step of the curve between adjacent targets that does not exceed the resolution and the scatter
/// of the readings, but would make a table steep.
struct Unresolved {
  double from = 0.0, to = 0.0;      ///< positions of the two targets, m or rad
  double step = 0.0;                ///< m or rad
  double resolution = 0.0;          ///< smallest difference of two readings, m or rad
  double slope = 0.0, limit = 0.0;  ///< slope of the step, and the exceeded limit; m/m or rad/rad
};

/// A mean reversal whose U is at least half of it, so that no backlash value is derived from it.
struct HeldReversal {
  double mean = 0.0;       ///< m or rad
  bool attention = false;  ///< severity: the runs repeat it, or it may be a fifth of A
};

/// One measured axis for which a table is to be written; SI.
struct AxisJob {
  std::string axis, measurement;
  std::string stem;  ///< start of file names; includes the measurement if an axis has two
  double backlash_step = 1e-9;  ///< resolution of the backlash parameter, m or rad
  std::size_t number = 0;       ///< axis number in the control; 0 if not stated
  bool rotary = false;
  math::ErrorCurve curve;  ///< curve to be compensated: as measured, or as the model predicts
  std::optional<math::ErrorCurve> measured;  ///< measured curve, if `curve` is the model's
  std::optional<math::ErrorCurve> turn;      ///< for a rotary axis measured over a whole revolution
  bool had_table = false;       ///< whether a table was active, which is removed from `curve`
  bool from_diagonals = false;  ///< positioning from step diagonals: the reversal is not known
  /// If false, `curve` is relative to its end-point line, because step diagonals alone do not
  /// determine the scale.
  bool scale_known = true;
  math::Reversal reversal;
  AxisSettings settings;           ///< from option `axes`
  std::vector<std::string> drift;  ///< ids of the findings with severity warning
  double drifted = 0.0;  ///< largest drift from the first run to the last that was found, m or rad
  std::optional<Unresolved> unresolved{};
  math::CompensatedUncertainty U;
  /// A mean reversal with a large uncertainty; `curve` is then the mean in both directions.
  std::optional<HeldReversal> held{};
  std::vector<std::string> suspects;  ///< suspect readings: "190.0 mm (3, +)"
  std::vector<std::string> about;     ///< header lines in plain ASCII: machine, axis, date

  /// The tables as the control reads them from the files; none if the table was refused.
  std::optional<std::vector<LoadedTable>> loaded{};

  const math::ErrorCurve& table_curve() const { return turn ? *turn : curve; }
  /// Backlash parameter of the control during the measurement (setting `backlash`), m or rad.
  double present_backlash() const { return position_setting("backlash").value_or(0.0); }
  /// New value of the backlash parameter, positive for lost motion, m or rad. The present value is
  /// kept if a single value would leave a larger reversal somewhere than exists now.
  double backlash() const {
    return one_value_helps()
               ? math::rounded({present_backlash() - curve.mean_reversal()}, backlash_step).front()
               : present_backlash();
  }
  /// The measured value, whether or not the table contains it.
  double mean_reversal() const { return held ? held->mean : curve.mean_reversal(); }
  /// Whether a single value compensates most of the reversal; independent of the pitch table.
  bool one_value_helps() const;
  /// Whether a table was requested despite drift (setting `drifted`).
  bool takes_drift() const { return setting("drifted").value_or(0.0) != 0.0; }
  /// Printed units per SI unit: mm per m, or deg per rad.
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
  std::string_view unit() const { return rotary ? "deg" : "mm"; }
  /// Returns a length or angle in SI: "first" reads first_mm or first_deg.
  std::optional<double> position_setting(std::string_view name) const;
  std::optional<double> setting(std::string_view name) const;
};

/// Whether the campaign contains measurements for a pitch table: axis runs, or step diagonals.
bool has_tables(const Campaign&);

/// Returns the axis measurements with readings, in the campaign's order, and the positioning from
/// step diagonals for axes without them. `keys` are settings in option `axes`: "reference" allows
/// reference_mm and reference_deg, a name that ends with ':' a plain number. Findings and notes are
/// added to `result`.
Expected<std::vector<AxisJob>> axis_jobs(const ControllerInput& input,
                                         const std::vector<std::string_view>& keys,
                                         OutputResult& result);

/// Returns true, with a finding that names the key and the file, if one of these axes has no stated
/// number in the control.
bool lacks_number(const std::vector<std::string>& of, const ControllerInput& input,
                  const std::vector<KnownAxis>& axes, const std::string& measurement,
                  OutputResult& result);

/// Whether the active table and the active backlash value during the measurement are stated;
/// otherwise adds a finding that names the missing keys. Without this statement, a table of the
/// remaining errors could replace a table that compensated the others.
bool states_active(const ControllerInput& input, const std::string& axis,
                   const std::string& measurement, bool backlash_in_options, OutputResult& result);

/// States that a control's format has no table for a measurement.
Remark not_in_format(const std::string& output, const std::string& measurement);

/// The text of the note may contain {axis} and {unit}.
Remark remark(const AxisJob& job, std::string id);

/// `keys` are listed in the help of the option.
Option axes_option(std::string keys);
/// The options step_mm and step_deg.
std::vector<Option> step_options();
/// From the settings of the axis or the options, m or rad; 0 if not stated.
double wished_step(const AxisJob& job, const Settings& options);

/// Returns true, with a finding, if the reversal varies along the axis by as much as the pitch
/// table compensates, and no direction tables are requested.
bool refused(const AxisJob& job, Columns columns, OutputResult& result);

/// Warning lines for the file of an axis with drift or suspect readings; empty otherwise.
std::vector<std::string> warnings(const AxisJob& job, OutputResult& result);
/// Text for the table's file that states how the reversal was treated.
std::string reversal_words(const AxisJob& job, Columns columns);

/// Adds findings about a single backlash value: the reversal varies along the axis; the value
/// brings no improvement; or the reversal is positive (over-travel) and the active compensation is
/// not stated, so that the written value would replace one that should be reduced.
void doubt_backlash(const AxisJob& job, OutputResult& result);

/// Adds the predictions of E, B and M before and after compensation, and a finding if the table
/// increases the mean deviations. `correction` is read back from the written bytes and contains
/// everything that the control adds; the present backlash value is subtracted here.
void predict(const AxisJob& job, const math::Correction& correction, OutputResult& result);

/// Position at which the table must be zero: the setting `reference` of the axis, otherwise 0 if
/// the table contains it, otherwise its end nearest to 0.
double reference_position(const AxisJob& job, double first, double last);

/// Converts to the unit of the axis: "12.5 mm".
std::string with_unit(const AxisJob& job, double si, int decimals);
/// "8.143 um" or "1.2 arcsec".
std::string deviation_words(const AxisJob& job, double si);

}  // namespace nonio::controllers
