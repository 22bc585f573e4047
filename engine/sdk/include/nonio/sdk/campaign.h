// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/settings.h"
#include "nonio/sdk/units.h"

namespace nonio {

/// One axis of the machine. Lengths in m, angles in rad. The ranges of all members of a campaign
/// are those of its keys, which the host checks (docs/manifest.md).
struct Axis {
  std::string name;
  bool rotary = false;
  std::optional<std::pair<double, double>> travel{};
  std::optional<double> screw_pitch{};  ///< period of the drive or scale, m
  std::optional<int> teeth{};           ///< periods per revolution of a rotary axis
  std::optional<double> expansion{};    ///< expansion coefficient of screw or scale, 1/K
  /// Position at which screw or scale is fixed, so that it does not move when the part expands, m.
  std::optional<double> fixed_point{};
  std::map<std::string, double> tolerance{};  ///< upper limits by the name of the result, m or rad
  /// for a gantry: name of the control's axis that drives the second side; otherwise empty
  std::string slave{};
  /// `active_table` and `active_backlash` state the compensation that was active in the control
  /// while the axis was measured; without a value it is not stated. `active_table` contains the
  /// files of the active table, and is empty if no table was active.
  std::optional<std::string> active_table{};
  std::optional<double> active_backlash{};  ///< active backlash value, m or rad; 0: none was active
};

struct Machine {
  std::string maker, model, serial;
  /// kind of machine, such as "gantry milling machine"; its condition at the calibration
  std::string description, condition;
  std::string structure;  ///< kind of structure: gantry, single-column, bridge, other; empty if not
                          ///< stated
  std::string control;    ///< name of the controller plugin that writes its tables; empty: any
  std::vector<Axis> axes;
  std::string asset{};  ///< the owner's inventory number; empty if not stated

  const Axis* axis(std::string_view name) const {
    for (const Axis& a : axes)
      if (a.name == name) return &a;
    return nullptr;
  }
};

/// The measuring instrument. U_* are expanded uncertainties (k = 2) of its certificate.
struct Instrument {
  std::string maker, model, serial, calibrated, certificate;
  std::optional<double> U_fixed;       ///< part of U that does not depend on length, m
  std::optional<double> U_per_length;  ///< part of U proportional to length, m/m
  std::optional<double> U_angle;       ///< expanded uncertainty (k = 2) of an angle, rad
  /// For a probe: full range of the form error of its ball, and of the error of the probe itself,
  /// m.
  std::optional<double> sphere{}, probe{};
  /// For a device with a length of its own (a scale, a step gauge): its expansion coefficient, 1/K,
  /// and the full ranges of its temperature, K, and of that coefficient, 1/K. None: its length does
  /// not depend on temperature, or U_per_length includes this.
  std::optional<double> expansion{}, temperature_range{}, expansion_range{};
  /// issuer of the calibration certificate; last day on which the certificate is valid
  std::string issuer{}, valid_until{};
};

/// A sensor whose readings compensate the instrument, or that measured the machine's temperature.
struct Sensor {
  std::string measures{};  ///< what it measures: material, air, pressure, humidity
  std::string maker{}, model{}, serial{}, calibrated{}, valid_until{}, certificate{}, issuer{};
};

/// A reference square, against whose faces the motions of two axes are measured.
struct Square {
  std::string name;
  /// deviation of the angle between its faces, rad: positive is more than 90 deg
  std::optional<double> error{};
  std::optional<double> U{};  ///< expanded uncertainty (k = 2) of `error`, rad
};

/// Test conditions, most of which are inputs of the uncertainty budget (ISO/TR 230-9:2005 Annex C).
/// Ranges are full ranges of the quantity.
struct Environment {
  /// misalignment of beam and axis, as lateral distance over the travel, m
  std::optional<double> misalignment;
  /// uncertainty range of the measured material temperature, K
  std::optional<double> temperature_range;
  /// largest distance of the material temperature from 20 degC, K
  std::optional<double> temperature_difference;
  std::optional<double> expansion_range;  ///< range of the expansion coefficient, 1/K
  std::optional<double> drift;            ///< range of the drift test (E_VE), m
  std::optional<double> drift_angle;      ///< range of the drift test of a rotary axis, rad
  std::string warm_up{};                  ///< how the machine was warmed up before the test
  std::string sensors{};                  ///< where the temperature sensors were
  std::optional<bool> normalised{};       ///< whether the readings were corrected to 20 degC
  std::optional<double> drift_time{};     ///< duration of the drift test, s
};

/// The smallest expanded uncertainty in the scope of an accreditation (CMC): fixed + per_length * L
/// for lengths.
struct Cmc {
  std::optional<double> fixed{};       ///< part that does not depend on length, m
  std::optional<double> per_length{};  ///< part proportional to length, m/m
  std::optional<double> angle{};       ///< smallest U of angles and directions, rad
  bool stated() const { return fixed || per_length || angle; }
};

struct Laboratory {
  std::string name, address, country, accreditation, authoriser, contact;
  Cmc cmc{};
};

/// Texts that a certificate contains in addition to the results (ISO/IEC 17025:2017, 7.8). They
/// come from site.toml, unless the campaign states them.
struct CertificateTexts {
  std::vector<std::string> languages;  ///< one or two languages of templates/words
  /// title by language; if absent, the title in templates/words
  std::map<std::string, std::string> title;
  std::string form;        ///< layout: name of a file in templates/, without .toml
  std::string location;    ///< place of calibration, as a DCC names it: customer, laboratory, ...
  std::string procedure;   ///< the laboratory's own procedure, in addition to the standards
  std::string deviations;  ///< additions to, deviations from and exclusions from the method
  /// conditions with influence on the results that the readings do not contain
  std::string conditions;
  std::string opinions;                    ///< opinions and interpretations, marked as such
  std::string amendment;                   ///< reason why an earlier certificate is replaced
  std::vector<std::string> customer_data;  ///< keys of the manifest that the customer stated
  /// person who states that the method was not changed in any other way
  std::string no_other_deviations_by{};
  std::string decision_rule{};  ///< iso14253-1, iso14253-1:2013, ilac-g8-simple or ilac-g8-guarded
};

/// An upper tolerance limit of the magnitude of one result.
struct Tolerance {
  std::string result;  ///< name of the result that it limits
  double limit = 0.0;  ///< largest allowed magnitude of the result, SI
  Quantity quantity = Quantity::deviation;
};

/// Returns the manifest key that states a tolerance of this quantity: "tolerance_um".
inline std::string tolerance_key(Quantity q) {
  return "tolerance" + std::string(unit_of(q).suffix);
}

/// One [[measurement]] of the manifest. The members from `axis` on that belong to keys of a method
/// (axis, lateral, from, to, order, side, reversal_of, square, foot) are empty if its method has no
/// such key.
struct Measurement {
  std::string id;
  std::string kind;  ///< what was measured: name of the method, or its `Method::observed_as`
  std::string axis;
  /// for a straightness, the direction of the deviation; for an angle, the axis of rotation
  /// (`about`)
  std::string lateral;
  std::string file;
  std::string reader;  ///< name of the reader plugin; empty: chosen by the file's content
  std::map<std::string, double> from, to;  ///< ends of a diagonal, m
  std::vector<std::uint32_t> exclude{};    ///< lines of the file whose readings are not used
  std::string exclude_reason{};            ///< reason for the exclusion; a certificate requires it
  /// The manifest's statements about a recorded channel; role: "air", "structure", "source",
  /// "coolant".
  struct Channel {
    std::string name, place, role;
  };
  std::vector<Channel> channels{};
  /// positions of the axes that did not move during the measurement, m
  std::map<std::string, double> at{};
  /// "before" or "after" an adjustment of the machine; empty: not stated
  std::string adjustment{};
  /// Order of the targets of rows without times: "pendulum", "as-listed", "unknown"; empty: not
  /// stated.
  std::string order{};

  /// Test conditions that ISO 230-2 requires in the report; empty members were not stated.
  std::optional<double> feed{};                 ///< feed rate, m/s or rad/s
  std::optional<double> dwell{};                ///< time at rest at a target before the reading, s
  std::optional<double> over_travel{};          ///< distance moved beyond the last target, m or rad
  std::map<std::string, double> tool_offset{};  ///< vector from the spindle nose to the probe, m
  /// vector from the table to the measured point, m
  std::map<std::string, double> workpiece_offset{};
  std::string compensation{};  ///< "on" or "off": whether the control's tables were active
  std::string side{};          ///< for a gantry axis: "master" or "slave"; empty: not stated
  std::optional<std::string>
      state{};  ///< state of the machine as the manifest states it; see `state_of`
  /// For a straightness: id of the measurement of the same line before the straightedge was turned
  /// over.
  std::string reversal_of{};
  /// length of the base of a level or mirror that was moved step by step by this length, m
  std::optional<double> foot{};
  std::string square{};  ///< for a straightness: name of the square on whose face it was measured
  /// whether it was measured after the square was turned over about a face
  bool square_turned = false;
  /// Tolerances of this measurement's results. They replace those of its axis with the same name.
  std::vector<Tolerance> tolerances{};
  /// Values of the keys that the method declares, in the unit of the manifest; defaults are filled
  /// in.
  Settings settings{};
  std::string method{};  ///< name of the method (manifest key `kind`); if empty, `kind` is the name
  /// Motion of the machine during the measurement. It decides which readings repeat at targets, and
  /// whether effects of a model apply.
  enum class Motion {
    targets,     ///< motion with stops at targets, which the runs share
    path,        ///< motion without stops over an angle, such as a circle
    time,        ///< readings over time, at rest or while an axis is exercised
    placements,  ///< readings of features of an artefact in several placements
    none         ///< no axis of the machine moved
  };
  Motion motion = Motion::targets;  ///< motion during the measurement, as the method declares it
};

inline const std::string& method_name(const Measurement& m) {
  return m.method.empty() ? m.kind : m.method;
}

/// Returns the state of the machine in which a measurement was made, such as "final"; empty if the
/// measurement is valid for every state. Without the key `state`, it is the text after the first
/// space of the id ("D1 final").
inline std::string state_of(const Measurement& m) {
  if (m.state) return *m.state;
  const std::size_t space = m.id.find(' ');
  return space == std::string::npos ? std::string() : m.id.substr(space + 1);
}

/// Returns the name of the control's axis whose scale was measured: on the second side of a gantry
/// the slave axis, otherwise the axis itself.
inline std::string control_axis(const Machine& machine, const Measurement& m) {
  const Axis* axis = machine.axis(m.axis);
  return m.side == "slave" && axis != nullptr ? axis->slave : m.axis;
}

/// An effect that the user defines by an expression in the manifest, without compiling a plugin.
struct Formula {
  struct Parameter {
    std::string name;
    Quantity quantity = Quantity::number;
    double start = 0.0;  ///< initial value of the fit, SI
    /// range that is searched, SI; if absent, the parameter is linear
    std::optional<std::pair<double, double>> range{};
  };
  std::string name, axis, expression;
  std::vector<Parameter> parameters;
  std::uint64_t line = 0;  ///< line of the manifest that contains the expression
};

struct Campaign {
  std::string id, customer, site, operator_name, date;  ///< date as YYYY-MM-DD, or empty
  std::string customer_address;
  /// day of the last measurement; day on which the item was received; YYYY-MM-DD, or empty
  std::string end_date, received;
  Machine machine;
  Instrument instrument;
  std::vector<Sensor> sensors{};
  std::vector<Square> squares{};
  Environment environment;
  Laboratory laboratory;
  CertificateTexts certificate;
  std::vector<Measurement> measurements;
  std::vector<std::string> model;  ///< effects of the model, as `kind:axis`
  /// whether tables compensate the model's prediction instead of the mean readings
  bool compensate_model = false;
  std::vector<Formula> formulas;
};

}  // namespace nonio
