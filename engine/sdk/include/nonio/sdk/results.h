// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/budget.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/units.h"

namespace nonio {

/// A number with its name. In evidence the unit becomes part of the name: mean -> mean_um.
struct Number {
  std::string name;
  double value = 0.0;  ///< SI
  Quantity quantity = Quantity::number;
};

/// A result. What cannot be given is absent from the list, and a finding states why. What of a
/// value is followed over the campaigns of its machine. Only values that are linear in the readings
/// can be: a largest deviation grows with the number of runs.
struct Followed {
  std::string quantity;  ///< its name in the history: "squareness:XY"
  std::string axis;      ///< of the control; of a plane or pair both, "XY"
  /// What campaigns must have alike to be compared; numbers in the units that are printed.
  std::vector<std::pair<std::string, double>> numbers{};
  std::vector<std::pair<std::string, std::string>> texts{};
};

struct Value {
  std::string name;  ///< the standard's: A, R+, Ps_max
  double value = 0.0;
  Quantity quantity = Quantity::number;
  std::optional<double> U{};  ///< expanded uncertainty
  double k = 2.0;             ///< the coverage factor of `U` or of `repeatability`
  /// Where a contribution was not stated, in place of U: the expanded scatter of the fit alone.
  std::optional<double> repeatability{};
  /// Followed if the budget has its uncertainty; see Analysis::states_followed.
  std::optional<Followed> followed{};
};

/// Something that the numbers mean. Its words are looked up by `id` in templates/words, with
/// `{name_unit}` places for the evidence; `advice` is only for plugins without words there.
struct Finding {
  std::string id;          ///< "reversal.not-constant"
  bool attention = false;  ///< severity: attention, else info
  std::vector<Number> evidence{};
  std::vector<std::pair<std::string, std::string>> texts{};  ///< evidence that is not a number
  std::string measurement{};
  std::string advice{};
};

/// Information that requires no action. Its words are the text `note.<id>` of
/// templates/words, with places as a finding has them; `english` is for plugins without words
/// there.
struct Remark {
  std::string id;
  std::vector<Number> evidence{};
  std::vector<std::pair<std::string, std::string>> texts{};
  std::string measurement{};
  std::string english{};
};

/// Values by row; NaN where one cannot be given.
struct PointTable {
  struct Column {
    std::string name;
    Quantity quantity = Quantity::number;
    std::vector<double> values;
    std::optional<double> U{};  ///< of each of its values, k = 2: an upper bound
  };
  std::vector<Column> columns;  ///< all of the same length

  const Column* column(std::string_view name) const {
    for (const Column& c : columns)
      if (c.name == name) return &c;
    return nullptr;
  }
};

/// A curve over an axis.
struct Series {
  std::string name;  ///< ISO 230-1: EYX
  std::string over;  ///< the axis
  Quantity position_quantity = Quantity::length;
  Quantity quantity = Quantity::deviation;
  std::vector<double> position, value, U;
  double k = 2.0;                       ///< of U or of `repeatability`
  std::vector<double> repeatability{};  ///< in place of U, as in Value
};

/// The results of an analysis for one measurement, or for the campaign.
struct Evaluation {
  std::vector<Value> values;
  PointTable points;  ///< a row a target: the first column is `target`
  PointTable rows;    ///< a row something else: a plan
  std::vector<Series> series;
  std::vector<Finding> findings;
  std::vector<Remark> notes;
  std::vector<std::string> uses{};  ///< ids of the other measurements that it is made from
  std::optional<UncertaintyBudget> budget{};
};

/// One result before a table is loaded, and as its consumer's model predicts it after.
struct Prediction {
  std::string measurement;
  std::string name;  ///< E, A, B
  double before = 0.0, after = 0.0;
  Quantity quantity = Quantity::deviation;
};

struct Artifact {
  std::string name;  ///< a plain file name
  std::string bytes;
  bool sign = false;  ///< a PDF or an XML file that the host signs before it is published
};

/// What an output makes of a campaign. A refusal is a finding, not an error.
struct OutputResult {
  std::vector<Artifact> artifacts;
  std::vector<Prediction> predictions;
  std::vector<Finding> findings;
  std::vector<Remark> notes;  ///< what is only inferred about a format, for example
};

/// One place of a file that is other than it was: a key of a TOML file or a line of readings. What
/// was missing before, or is not there any more, is absent.
struct Change {
  std::string key;         ///< "machine.axes.X.tolerance_um.B"; empty: a line
  std::uint64_t line = 0;  ///< 1-based, in the present file; of a removed entry: in the former file
  std::optional<std::string> before{}, after{};
};

/// A file that is other than it was. Without `changes`: all of it.
struct FileChange {
  std::string file;
  std::vector<Change> changes{};
  std::uint64_t more = 0;  ///< number of further places
};

/// The number under which something is issued, drawn by the host; dates as YYYY-MM-DD. Before a
/// person has released it there is no number: a draft, and every page of it must state that.
struct Issue {
  std::string number, date;
  std::string replaces, replaces_date;  ///< the one that this amends; empty: none
  std::vector<FileChange> changes;      ///< what is other than in the one that it replaces
  std::string readings_sha256;          ///< of the files of readings, one behind the other
  std::string replaces_readings{};      ///< readings_sha256 of the one that it replaces
  std::string replaces_file{};          ///< a file of that one, its DCC if it has one,
  std::string replaces_sha256{};        ///< and its digest
  std::string why{};                    ///< the other one is replaced
  std::string released_by{};  ///< the person; empty: the laboratory's rules for automatic release
  std::string author{};       ///< who has approved it before, where that is another person
  /// Why it is issued in spite of a finding that a certificate states: an expired calibration.
  struct Reason {
    std::string finding, text, by;  ///< id of the finding; the reason; who stated it
  };
  std::vector<Reason> reasons{};
  /// Of the register: its identity, no two have the same; the entry under which the number was
  /// drawn, and the digest of the register up to there.
  std::string register_id{}, register_entry{}, register_sha256{};
  bool is_draft() const { return number.empty(); }
};

/// Of a certificate, the same nowhere else: its number and what was read.
inline std::string identifier_of(std::string_view number, std::string_view readings_sha256) {
  return std::string(number) + "." + std::string(readings_sha256);
}

/// Of a result y with expanded uncertainty U against an upper limit T, by the rule of the
/// certificate. ISO 14253-1: conforms y <= T - U, does not conform y > T + U, between them it is
/// indeterminate (docs/howto-certificate.md has the other rules).
enum class Decision { conforms, does_not_conform, cannot_be_decided };

/// One tolerance of the manifest compared with one result.
struct Conformity {
  std::string measurement, axis, plugin, name;  ///< axis: empty where none was measured
  double tolerance = 0.0;
  Quantity quantity = Quantity::deviation;
  Decision decision = Decision::cannot_be_decided;
  std::string reason;  ///< why it is indeterminate: "no-uncertainty", "no-value", "near-limit"
};

/// A model compared with the readings of one part of the machine, such as an axis: the source of
/// the pictures and tables of documents. SI. Columns have an entry for each reading, or none where
/// the files did not have them; the prediction is deviation - residual.
struct ModelFit {
  /// A curve as people read it: m or rad, at places of the readings (m or rad along their line).
  struct Curve {
    double rms = 0.0, low = 0.0, high = 0.0;
    std::optional<double> low_at{}, high_at{};  ///< absent where it is no function of place
  };
  struct Parameter {
    std::string effect, name;  ///< "backlash:X", "b"
    double value = 0.0;
    std::optional<double> u{};  ///< standard uncertainty
    Quantity quantity = Quantity::number;
    bool searched = false;  ///< a shape: period, time constant, instant
  };
  struct Effect {
    std::string name;                  ///< "backlash:X"
    bool compensable = false;          ///< a table in the controller can take it away
    std::vector<double> contribution;  ///< what it predicts for each reading; m or rad
    std::optional<Curve> curve{};      ///< of a curve: what its parameters come to
  };
  /// The model fitted again without one of its effects.
  struct Without {
    std::string effect;
    double rms = 0.0;
    std::optional<double> cv_rms{};
    std::vector<double> residual{};  ///< of each reading
  };
  /// An effect that is not in the model, with evidence for it; m or rad.
  struct Candidate {
    std::string effect;
    double score = 0.0;  ///< 2 ln of the evidence
    double rms = 0.0;    ///< with it in the model
    std::optional<double> cv_rms{};
    double p = 1.0;
    double smallest = 0.0;             ///< rms of one that would be found nine times in ten
    std::vector<std::string> aliases;  ///< these readings do not separate them from it
    bool certain = false;              ///< whatever the rest is
  };
  /// The error as the model grows: first without any effect, then with one more at a time, that
  /// which takes most away.
  struct Step {
    std::string effect;  ///< the one that came in; empty for the first
    double rms = 0.0;
    std::optional<double> cv_rms{};  ///< of runs left out one at a time; absent with one run
  };
  /// A temperature, speed or load that was recorded during the readings.
  struct Channel {
    std::string name, unit;      ///< "bearing", "degC"
    bool used = false;           ///< by an effect of the model
    std::vector<double> values;  ///< at each reading
  };
  struct Suspect {
    std::size_t row = 0;
    double minimal_detectable = 0.0;  ///< an error here below this would not have been seen
  };

  std::string part;                       ///< a file can be named by it: "X"
  std::vector<std::string> measurements;  ///< ids
  std::string axis;
  bool rotary = false;             ///< positions are angles, in rad
  bool angular = false;            ///< deviations are angles, in rad
  std::optional<double> period{};  ///< of the drive: screw pitch in m, or rad between two teeth

  std::vector<std::uint32_t> measurement;  ///< index into `measurements`
  std::vector<std::uint32_t> source_line;  ///< line of the file, 1-based
  std::vector<std::uint32_t> run;          ///< as numbered in the file, from 1
  std::vector<double> target;
  std::vector<std::int8_t> direction;  ///< +1, -1; 0 if it is not known
  std::vector<double> time;            ///< s; NaN where blank
  std::vector<double> temperature;     ///< of the material, degC; NaN where blank
  std::vector<double> deviation, residual;
  std::vector<double> weight;       ///< 0..1: small where a misreading is suspected
  std::vector<double> cv_residual;  ///< predicted without its run; none with one run

  std::vector<Effect> effects;  ///< of the model, in its order
  std::vector<Parameter> parameters;
  std::vector<std::vector<double>> correlation;  ///< of `parameters`
  std::vector<Step> steps;                       ///< the last one is the model
  std::optional<double> floor{}, floor_u{};      ///< scatter of repeats, its standard uncertainty
  std::vector<Suspect> suspects;
  std::vector<Finding> diagnosis;       ///< the verdict, then what else the model predicts
  std::vector<Without> without{};       ///< for each effect that can be left out
  std::vector<Candidate> candidates{};  ///< most evidence first
  /// Of the others, "No sign of A (would be seen from 1 um)", "B (2 um)", ...: one sentence.
  std::vector<Finding> no_sign{};
  std::vector<Finding> next{};  ///< what to measure next
  std::vector<Channel> channels{};

  std::size_t size() const { return deviation.size(); }
};

/// Everything known of a campaign so far; what outputs read and results.json holds.
struct Results {
  struct Analysed {
    std::string plugin, version, measurement;  ///< measurement: empty if of the campaign
    Evaluation evaluation;
    std::string part{};  ///< of the model: "warm/z"; empty where the measurement states it
  };
  struct Written {
    std::string plugin, version;
    OutputResult result;  ///< artifacts with their names and bytes
  };
  std::vector<Error> errors;
  std::vector<Analysed> analyses;
  std::vector<ModelFit> models;
  std::vector<Conformity> conformity;
  std::vector<Written> outputs;
  std::vector<Remark> notes;
};

}  // namespace nonio
