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

/// One axis of the machine. Lengths in m, angles in rad. Ranges of all values of a campaign are
/// those of its keys, which the host checks (docs/manifest.md).
struct Axis {
  std::string name;
  bool rotary = false;
  std::optional<std::pair<double, double>> travel{};
  std::optional<double> screw_pitch{};  ///< m; period of the drive or scale
  std::optional<int> teeth{};           ///< periods per revolution of a rotary axis
  std::optional<double> expansion{};    ///< 1/K
  /// Where screw or scale is held and does not move when it grows: m.
  std::optional<double> fixed_point{};
  std::map<std::string, double> tolerance{};  ///< upper limit of a result, by its name: m or rad
  std::string slave{};  ///< of a gantry: name of the control's axis that drives the second side
  /// The compensation that was active in the control while the axis was measured; none: not stated.
  std::optional<std::string> active_table{};  ///< files of the table; empty: there was none
  std::optional<double> active_backlash{};    ///< m or rad; 0: there was none
};

struct Machine {
  std::string maker, model, serial;
  std::string description, condition;  ///< "gantry milling machine"; its state at the calibration
  std::string structure;  ///< gantry, single-column, bridge, other; empty if not stated
  std::string control;    ///< name of the output plugin that writes its tables; empty: any
  std::vector<Axis> axes;
  std::string asset{};  ///< the machine's own number in the house; empty if not stated

  const Axis* axis(std::string_view name) const {
    for (const Axis& a : axes)
      if (a.name == name) return &a;
    return nullptr;
  }
};

/// The measuring instrument; U are expanded uncertainties (k = 2) of its certificate.
struct Instrument {
  std::string maker, model, serial, calibrated, certificate;
  std::optional<double> U_fixed;       ///< m
  std::optional<double> U_per_length;  ///< m/m
  std::optional<double> U_angle;       ///< rad
  /// Of a probe: full ranges of the form of its ball, and of what the probe itself adds, m.
  std::optional<double> sphere{}, probe{};
  /// Of a device that has a length of its own (a scale, a step gauge); none: its length does not
  /// depend on its temperature, or that is in U_per_length. 1/K, K and 1/K, the latter full ranges.
  std::optional<double> expansion{}, temperature_range{}, expansion_range{};
  std::string issuer{}, valid_until{};  ///< of its certificate: who issued it, its last day
};

/// A sensor of what the instrument is compensated by or the machine was held at.
struct Sensor {
  std::string measures{};  ///< material, air, pressure, humidity
  std::string maker{}, model{}, serial{}, calibrated{}, valid_until{}, certificate{}, issuer{};
};

/// A square against whose faces two axes are read.
struct Square {
  std::string name;
  std::optional<double> error{};  ///< rad, of the angle between its faces: positive is over 90 deg
  std::optional<double> U{};      ///< rad, of `error`, k = 2
};

/// What the uncertainty budget needs in addition to the instrument (ISO/TR 230-9:2005 Annex C);
/// each is the full range of the quantity.
struct Environment {
  std::optional<double> misalignment;            ///< m, beam against axis over the travel
  std::optional<double> temperature_range;       ///< K, of the material temperature's reading
  std::optional<double> temperature_difference;  ///< K, largest distance from 20 degC
  std::optional<double> expansion_range;         ///< 1/K, of the expansion coefficient
  std::optional<double> drift;                   ///< m, range of the drift test (E_VE)
  std::optional<double> drift_angle;             ///< rad, the same of a rotary axis
  std::string warm_up{};                         ///< what the machine did before the test
  std::string sensors{};                         ///< where the temperature sensors were
  std::optional<bool> normalised{};              ///< whether the readings were corrected to 20 degC
  std::optional<double> drift_time{};            ///< s, how long the drift test took
};

/// The smallest expanded uncertainty that an accreditation covers (CMC): a + b L for lengths.
struct Cmc {
  std::optional<double> fixed{};       ///< m
  std::optional<double> per_length{};  ///< m/m
  std::optional<double> angle{};       ///< rad, of angles and directions
  bool stated() const { return fixed || per_length || angle; }
};

struct Laboratory {
  std::string name, address, country, accreditation, authoriser, contact;
  Cmc cmc{};
};

/// What a certificate states in addition to the results (ISO/IEC 17025:2017, 7.8): from site.toml,
/// unless the campaign states it.
struct CertificateTexts {
  std::vector<std::string> languages;        ///< one or two, of templates/words
  std::map<std::string, std::string> title;  ///< by language; none: the words' own
  std::string form;                          ///< name of a file in templates/, without .toml
  std::string location;                      ///< as a DCC names it: customer, laboratory, ...
  std::string procedure;                     ///< the laboratory's own, in addition to the standards
  std::string deviations;                    ///< additions to the method, deviations, exclusions
  std::string conditions;                    ///< influences on the results that no reading contains
  std::string opinions;                      ///< opinions and interpretations, marked as such
  std::string amendment;                     ///< why an earlier certificate is replaced
  std::vector<std::string> customer_data;    ///< keys of the manifest that the customer stated
  std::string no_other_deviations_by{};  ///< who states that nothing else was changed in the method
  std::string decision_rule{};           ///< iso14253-1, ilac-g8-simple, ilac-g8-guarded
};

/// An upper limit of the magnitude of a result.
struct Tolerance {
  std::string result;  ///< its name
  double limit = 0.0;  ///< SI
  Quantity quantity = Quantity::deviation;
};

/// The key of the manifest that gives it.
inline std::string tolerance_key(Quantity q) {
  return "tolerance" + std::string(unit_of(q).suffix);
}

/// One [[measurement]]. The members from `axis` on that belong to keys of a method (axis, lateral,
/// from, to, order, side, reversal_of, square, foot) are empty where its method has no such key.
struct Measurement {
  std::string id;
  std::string kind;  ///< what was observed: name of the method, or its `Method::observed_as`
  std::string axis;
  std::string lateral;  ///< direction of a straightness; axis about which an angle turns (`about`)
  std::string file;
  std::string reader;                      ///< empty: chosen by content
  std::map<std::string, double> from, to;  ///< ends of a diagonal, m
  std::vector<std::uint32_t> exclude{};    ///< lines of the file whose readings do not count
  std::string exclude_reason{};            ///< why they do not; a certificate needs it
  /// What the manifest states about a recorded channel; role: "air", "structure", "source",
  /// "coolant".
  struct Channel {
    std::string name, place, role;
  };
  std::vector<Channel> channels{};
  std::map<std::string, double> at{};  ///< positions of the axes that did not move, m
  std::string adjustment{};            ///< "before" or "after" one; empty: not stated
  /// Of the rows, where they have no times: "pendulum", "as-listed", "unknown"; empty: not stated.
  std::string order{};

  /// How the test was made, as ISO 230-2 requires it reported; what is empty was not stated.
  std::optional<double> feed{};                      ///< m/s, rad/s
  std::optional<double> dwell{};                     ///< s, at a target before it is read
  std::optional<double> over_travel{};               ///< m or rad, beyond the last target
  std::map<std::string, double> tool_offset{};       ///< m, from the spindle nose to the probe
  std::map<std::string, double> workpiece_offset{};  ///< m, from the table to the place measured
  std::string compensation{};                        ///< "on" or "off": the control's tables
  std::string side{};  ///< of a gantry axis: "master" or "slave"; empty: not stated
  std::optional<std::string>
      state{};  ///< of the machine, as the manifest states it; see `state_of`
  /// Of a straightness: id of the same line's measurement before the straightedge was turned over.
  std::string reversal_of{};
  std::optional<double> foot{};  ///< m, of a level or mirror that was moved by its own length
  std::string square{};          ///< of a straightness: the square on whose face it was read
  bool square_turned = false;    ///< after the square was turned over about one of its faces
  /// Of this measurement's results. They hold in place of those of its axis with the same name.
  std::vector<Tolerance> tolerances{};
  /// The keys that the method declares, in the unit of the file, each with its value or its default.
  Settings settings{};
  std::string method{};  ///< its name, the key `kind`; empty: `kind` is the name
  /// What its readings follow: which of them repeat at targets, and whether effects of a model apply.
  enum class Motion {
    targets,     ///< stops at targets, which the runs share
    path,        ///< without stops, over an angle: a circle
    time,        ///< over time, at rest or with an axis that is exercised
    placements,  ///< features of an artefact in several placements
    none         ///< no axis of the machine moved
  };
  Motion motion = Motion::targets;  ///< as the method declares it
};

inline const std::string& method_name(const Measurement& m) {
  return m.method.empty() ? m.kind : m.method;
}

/// State of the machine in which something was measured: "final". Empty: it holds for every state.
/// A manifest without key `state` has it after the first space of the id ("D1 final").
inline std::string state_of(const Measurement& m) {
  if (m.state) return *m.state;
  const std::size_t space = m.id.find(' ');
  return space == std::string::npos ? std::string() : m.id.substr(space + 1);
}

/// The axis of the control whose scale a measurement of an axis was made on: on the second side of
/// a gantry the slave, else the axis itself.
inline std::string control_axis(const Machine& machine, const Measurement& m) {
  const Axis* axis = machine.axis(m.axis);
  return m.side == "slave" && axis != nullptr ? axis->slave : m.axis;
}

/// An effect of the user's own, without compiling.
struct Formula {
  struct Parameter {
    std::string name;
    Quantity quantity = Quantity::number;
    double start = 0.0;                                ///< SI
    std::optional<std::pair<double, double>> range{};  ///< SI; absent: it enters linearly
  };
  std::string name, axis, expression;
  std::vector<Parameter> parameters;
  std::uint64_t line = 0;  ///< of the manifest, with the expression
};

struct Campaign {
  std::string id, customer, site, operator_name, date;  ///< date as YYYY-MM-DD, or empty
  std::string customer_address;
  std::string end_date, received;  ///< of the last measurement; of the item; YYYY-MM-DD, or empty
  Machine machine;
  Instrument instrument;
  std::vector<Sensor> sensors{};
  std::vector<Square> squares{};
  Environment environment;
  Laboratory laboratory;
  CertificateTexts certificate;
  std::vector<Measurement> measurements;
  std::vector<std::string> model;  ///< effects, `kind:axis`
  bool compensate_model = false;   ///< tables take what the model predicts, not the readings' means
  std::vector<Formula> formulas;
};

}  // namespace nonio
