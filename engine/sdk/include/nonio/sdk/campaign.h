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

/// Lengths are in m, angles in rad. The host has checked the ranges of all members of a campaign
/// (docs/manifest.md).
struct Axis {
  std::string name;
  bool rotary = false;
  std::optional<std::pair<double, double>> travel{};
  std::optional<double> screw_pitch{};  ///< period of the drive or scale, m
  std::optional<int> teeth{};           ///< periods per revolution of a rotary axis
  std::optional<double> expansion{};    ///< expansion coefficient of screw or scale, 1/K
  /// Position at which the screw or scale is fixed to the machine, m.
  std::optional<double> fixed_point{};
  std::map<std::string, double> tolerance{};  ///< upper limits by result name, m or rad
  /// For a gantry: name of the control's axis that drives the second side; otherwise empty.
  std::string slave{};
  /// Compensation that was active in the control during the measurement; std::nullopt if the
  /// manifest does not state it. `active_table` contains the files of the table and is empty
  /// without a table.
  std::optional<std::string> active_table{};
  std::optional<double> active_backlash{};  ///< m or rad; 0 if no value was active
};

struct Machine {
  std::string maker, model, serial;
  /// Kind of machine ("gantry milling machine"), and its condition at the calibration.
  std::string description, condition;
  std::string structure;  ///< gantry, single-column, bridge, other; empty if not stated
  /// Name of the controller plugin that writes tables; the default controllers if empty.
  std::string control;
  std::vector<Axis> axes;
  std::string asset{};  ///< the owner's inventory number; empty if not stated

  const Axis* axis(std::string_view name) const {
    for (const Axis& a : axes)
      if (a.name == name) return &a;
    return nullptr;
  }
};

/// U_* are expanded uncertainties (k = 2) according to the calibration certificate.
struct Instrument {
  std::string maker, model, serial, calibrated, certificate;
  std::optional<double> U_fixed;       ///< part of U that does not depend on length, m
  std::optional<double> U_per_length;  ///< part of U proportional to length, m/m
  std::optional<double> U_angle;       ///< expanded uncertainty (k = 2) of an angle, rad
  /// For a probe: full ranges of the form error of its ball and of the probing error, m.
  std::optional<double> sphere{}, probe{};
  /// For a material measure (scale, step gauge): expansion coefficient, 1/K, and the full ranges of
  /// its temperature, K, and of that coefficient, 1/K. std::nullopt if its length does not depend
  /// on temperature, or if U_per_length includes this effect.
  std::optional<double> expansion{}, temperature_range{}, expansion_range{};
  /// Issuer of the calibration certificate, and last day of its validity.
  std::string issuer{}, valid_until{};
};

/// A sensor whose readings compensate the instrument, or that measured the machine's temperature.
struct Sensor {
  std::string measures{};  ///< material, air, pressure or humidity
  std::string maker{}, model{}, serial{}, calibrated{}, valid_until{}, certificate{}, issuer{};
};

/// A reference square, against whose faces the motions of two axes are measured.
struct Square {
  std::string name;
  /// Deviation of the angle between its faces, rad; positive if the angle exceeds 90 deg.
  std::optional<double> error{};
  std::optional<double> U{};  ///< expanded uncertainty (k = 2) of `error`, rad
};

/// Test conditions, most of which are inputs of the uncertainty budget (ISO/TR 230-9:2005 Annex C).
/// Ranges are full ranges.
struct Environment {
  /// Misalignment of beam and axis: lateral distance over the travel, m.
  std::optional<double> misalignment;
  /// Range of the uncertainty of the measured material temperature, K.
  std::optional<double> temperature_range;
  /// Largest difference between material temperature and 20 degC, K.
  std::optional<double> temperature_difference;
  std::optional<double> expansion_range;
  std::optional<double> drift;         ///< range of the drift test (E_VE), m
  std::optional<double> drift_angle;   ///< range of the drift test of a rotary axis, rad
  std::string warm_up{};               ///< how the machine was warmed up before the test
  std::string sensors{};               ///< positions of the temperature sensors
  std::optional<bool> normalised{};    ///< whether the readings were corrected to 20 degC
  std::optional<double> drift_time{};  ///< duration of the drift test, s
};

/// Smallest expanded uncertainty in the scope of an accreditation (calibration and measurement
/// capability, CMC): fixed + per_length * L for lengths.
struct Cmc {
  std::optional<double> fixed{};       ///< m
  std::optional<double> per_length{};  ///< m/m
  std::optional<double> angle{};       ///< for angles and directions, rad
  bool stated() const { return fixed || per_length || angle; }
};

struct Laboratory {
  std::string name, address, country, accreditation, authoriser, contact;
  Cmc cmc{};
};

/// Texts of a certificate in addition to the results (ISO/IEC 17025:2017, 7.8), from site.toml
/// unless the campaign states them.
struct CertificateTexts {
  std::vector<std::string> languages;  ///< one or two languages of templates/words
  /// Title by language; the default is in templates/words.
  std::map<std::string, std::string> title;
  std::string form;        ///< layout: name of a file in templates/, without .toml
  std::string location;    ///< place of calibration in DCC terms: customer, laboratory, ...
  std::string procedure;   ///< the laboratory's own procedure, in addition to the standards
  std::string deviations;  ///< additions to, deviations from and exclusions from the method
  /// Environmental conditions that influence the results and are not in the readings.
  std::string conditions;
  std::string opinions;                    ///< opinions and interpretations, marked as such
  std::string amendment;                   ///< reason for replacing an earlier certificate
  std::vector<std::string> customer_data;  ///< manifest keys of data that the customer provided
  /// Person who confirms that there were no other deviations from the method.
  std::string no_other_deviations_by{};
  std::string decision_rule{};
};

/// Upper tolerance limit of the magnitude of one result.
struct Tolerance {
  std::string result;
  double limit = 0.0;  ///< largest permissible magnitude, SI
  Quantity quantity = Quantity::deviation;
};

/// Returns a manifest key: "tolerance_um".
inline std::string tolerance_key(Quantity q) {
  return "tolerance" + std::string(unit_of(q).suffix);
}

/// One [[measurement]] of the manifest. Members from `axis` on that belong to keys of a method
/// (axis, lateral, from, to, order, side, reversal_of, square, foot) are empty if the method has no
/// such key.
struct Measurement {
  std::string id;
  std::string kind;  ///< name of the method, or its `Method::observed_as`
  std::string axis;
  /// For a straightness: direction of the deviation; for an angle: axis of rotation (`about`).
  std::string lateral;
  std::string file;
  std::string reader;  ///< name of the reader plugin; selected by the file's content if empty
  std::map<std::string, double> from, to;  ///< start and end of a diagonal, m
  std::vector<std::uint32_t> exclude{};    ///< lines of the file that are not used
  std::string exclude_reason{};            ///< required by a certificate
  /// Statement about a recorded channel. Its role is "air", "structure", "source" or "coolant".
  struct Channel {
    std::string name, place, role;
  };
  std::vector<Channel> channels{};
  /// Positions of the axes that did not move during the measurement, m.
  std::map<std::string, double> at{};
  /// "before" or "after" an adjustment of the machine; empty if not stated.
  std::string adjustment{};
  /// Order of the targets of rows without times: "pendulum", "as-listed" or "unknown"; empty if not
  /// stated.
  std::string order{};

  /// Test conditions that ISO 230-2 requires in the report; empty members were not stated.
  std::optional<double> feed{};                 ///< feed rate, m/s or rad/s
  std::optional<double> dwell{};                ///< time at rest at a target before the reading, s
  std::optional<double> over_travel{};          ///< distance moved beyond the last target, m or rad
  std::map<std::string, double> tool_offset{};  ///< vector from the spindle nose to the probe, m
  /// Vector from the table to the measured point, m.
  std::map<std::string, double> workpiece_offset{};
  std::string compensation{};  ///< "on" or "off": whether the control's tables were active
  std::string side{};          ///< for a gantry axis: "master" or "slave"; empty if not stated
  std::optional<std::string> state{};  ///< stated state of the machine; see `state_of`
  /// For a straightness: id of the measurement of the same line before the straightedge was
  /// reversed.
  std::string reversal_of{};
  /// Base length of a level or mirror that was moved step by step by this length, m.
  std::optional<double> foot{};
  std::string square{};  ///< for a straightness: name of the reference square
  /// Whether it was measured after the square was reversed about a face.
  bool square_turned = false;
  /// Tolerances that replace those of the axis for results of the same name.
  std::vector<Tolerance> tolerances{};
  /// Values of the keys that the method declares, in manifest units and including defaults.
  Settings settings{};
  std::string method{};  ///< manifest key `kind`; if empty, `kind` is the name
  /// Motion of the machine during the measurement, which determines what repeated readings are and
  /// which effects apply.
  enum class Motion {
    targets,     ///< stops at targets that are common to the runs
    path,        ///< motion without stops over an angle, such as a circle
    time,        ///< readings over time, at rest or while an axis is exercised
    placements,  ///< features of an artefact in several placements
    none         ///< no axis of the machine moved
  };
  Motion motion = Motion::targets;
};

inline const std::string& method_name(const Measurement& m) {
  return m.method.empty() ? m.kind : m.method;
}

/// Returns the state of the machine during a measurement, such as "final"; empty if the measurement
/// is valid for every state. Without the key `state`, the state is the text after the first space
/// of the id ("D1 final").
inline std::string state_of(const Measurement& m) {
  if (m.state) return *m.state;
  const std::size_t space = m.id.find(' ');
  return space == std::string::npos ? std::string() : m.id.substr(space + 1);
}

/// Returns the control's axis whose scale was measured: on the second side of a gantry the slave
/// axis, otherwise the axis itself.
inline std::string control_axis(const Machine& machine, const Measurement& m) {
  const Axis* axis = machine.axis(m.axis);
  return m.side == "slave" && axis != nullptr ? axis->slave : m.axis;
}

/// An effect that the manifest defines by an expression.
struct Formula {
  struct Parameter {
    std::string name;
    Quantity quantity = Quantity::number;
    double start = 0.0;  ///< initial value of the fit, SI
    /// Search range, SI; std::nullopt for a linear parameter.
    std::optional<std::pair<double, double>> range{};
  };
  std::string name, axis, expression;
  std::vector<Parameter> parameters;
  std::uint64_t line = 0;  ///< line of the expression in the manifest
};

struct Campaign {
  std::string id, customer, site, operator_name, date;  ///< date: YYYY-MM-DD or empty
  std::string customer_address;
  /// Last day of the measurements, and day on which the item was received; YYYY-MM-DD or empty.
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
  /// Whether tables compensate the model's prediction instead of the mean readings.
  bool compensate_model = false;
  std::vector<Formula> formulas;
};

}  // namespace nonio
