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

/// As evidence, the number is printed with the suffix of its unit: mean becomes mean_um.
struct Number {
  std::string name;
  double value = 0.0;  ///< SI
  Quantity quantity = Quantity::number;
};

/// How the history follows a value over the campaigns of its machine. Only values that are linear
/// in the readings can be followed; a largest deviation, for example, increases with the number of
/// runs.
struct Followed {
  std::string quantity;  ///< quantity in the history: "squareness:XY"
  std::string axis;      ///< axis of the control; for a plane or pair both, "XY"
  /// Conditions that must be equal for campaigns to be comparable; numbers in printed units.
  std::vector<std::pair<std::string, double>> numbers{};
  std::vector<std::pair<std::string, std::string>> texts{};
};

/// Conformity of a result y with expanded uncertainty U to an upper limit T. ISO 14253-1 with a
/// guard band g: conforms if y <= T - g, does not conform if y > T + g, otherwise indeterminate
/// (math/decision.h defines g and the other rules).
enum class Decision { conforms, does_not_conform, cannot_be_decided };

/// A limit that an analysis itself states for a value, such as a maximum permissible error at its
/// length, and its decision by the rule of the campaign.
struct JudgedLimit {
  double limit = 0.0;
  Decision decision = Decision::cannot_be_decided;
};

struct Value {
  std::string name;  ///< symbol of the standard: A, R+, Ps_max
  double value = 0.0;
  Quantity quantity = Quantity::number;
  std::optional<double> U{};  ///< expanded uncertainty with coverage factor `k`, SI
  double k = 2.0;             ///< coverage factor of `U` or of `repeatability`
  /// Expanded uncertainty from the scatter of the fit only, SI. Replaces `U` if a contribution to
  /// the budget was not stated.
  std::optional<double> repeatability{};
  /// Set if the history follows the value and the budget contains its uncertainty; see
  /// Analysis::states_followed.
  std::optional<Followed> followed{};
  std::optional<JudgedLimit> judged{};
};

/// A statement about the results. Its text is looked up by `id` in templates/words, with
/// placeholders `{name_unit}` for the evidence; `advice` is for plugins without such texts.
struct Finding {
  std::string id;          ///< "reversal.not-constant"
  bool attention = false;  ///< severity: attention if true, otherwise info
  std::vector<Number> evidence{};
  std::vector<std::pair<std::string, std::string>> texts{};  ///< evidence that is not a number
  std::string measurement{};
  std::string advice{};
};

/// Information that requires no action. Its text is `note.<id>` of templates/words, with
/// placeholders as in a finding; `english` is for plugins without such a text.
struct Remark {
  std::string id;
  std::vector<Number> evidence{};
  std::vector<std::pair<std::string, std::string>> texts{};
  std::string measurement{};
  std::string english{};
};

/// Columns of values with one row per point; NaN where there is no value.
struct PointTable {
  struct Column {
    std::string name;
    Quantity quantity = Quantity::number;
    std::vector<double> values;
    std::optional<double> U{};  ///< upper bound of the expanded uncertainty (k = 2) of each value
  };
  std::vector<Column> columns;  ///< equal numbers of values

  const Column* column(std::string_view name) const {
    for (const Column& c : columns)
      if (c.name == name) return &c;
    return nullptr;
  }
};

/// A curve of values over the positions of an axis.
struct Series {
  std::string name;  ///< symbol of ISO 230-1: EYX
  std::string over;
  Quantity position_quantity = Quantity::length;
  Quantity quantity = Quantity::deviation;
  std::vector<double> position, value, U;
  double k = 2.0;  ///< coverage factor of `U` or of `repeatability`
  /// Expanded uncertainty from the scatter of the fit only, SI; replaces `U` as in Value.
  std::vector<double> repeatability{};
};

struct Evaluation {
  std::vector<Value> values;
  PointTable points;  ///< one row per target; the first column is `target`
  PointTable rows;    ///< rows that are not targets, such as those of a plan
  std::vector<Series> series;
  std::vector<Finding> findings;
  std::vector<Remark> notes;
  std::vector<std::string> uses{};  ///< ids of the other measurements that were used
  std::optional<UncertaintyBudget> budget{};
};

/// A result before a table is loaded, and its predicted value after compensation.
struct Prediction {
  std::string measurement;
  std::string name;  ///< symbol of the result: E, A, B
  double before = 0.0, after = 0.0;
  Quantity quantity = Quantity::deviation;
};

struct Artifact {
  std::string name;
  std::string bytes;
  bool sign = false;  ///< a PDF or XML file that the host signs before publication
};

/// If an output refuses to write a file, it returns a finding, not an error.
struct OutputResult {
  std::vector<Artifact> artifacts;
  std::vector<Prediction> predictions;
  std::vector<Finding> findings;
  std::vector<Remark> notes;  ///< for example about a property of a format that is only inferred
};

/// A difference between two versions of a file: a key of a TOML file or a line of readings.
/// `before` is absent if it was added, `after` if it was removed.
struct Change {
  std::string key;  ///< "machine.axes.X.tolerance_um.B"; empty for a line of readings
  /// 1-based, in the present file, or in the former file if the entry was removed.
  std::uint64_t line = 0;
  std::optional<std::string> before{}, after{};
};

/// A file that differs from its former version. Without `changes`, the whole file differs.
struct FileChange {
  std::string file;
  std::vector<Change> changes{};
  std::uint64_t more = 0;  ///< number of further differences
};

/// The number under which the host issues a document; dates as YYYY-MM-DD. A document without a
/// number is a draft, and every page must state this.
struct Issue {
  std::string number, date;
  /// Number and date of the replaced document, or empty.
  std::string replaces, replaces_date;
  std::vector<FileChange> changes;  ///< differences from the input of the replaced document
  std::string readings_sha256;      ///< digest of the concatenated files of readings
  std::string replaces_readings{};  ///< `readings_sha256` of the replaced document
  std::string replaces_file{};      ///< a file of the replaced document: its DCC, if it has one
  std::string replaces_sha256{};
  std::string why{};  ///< reason for the replacement
  /// Person who approved the document; empty if the laboratory's automatic rules approved it.
  std::string released_by{};
  std::string author{};  ///< person who gave the first of two approvals, if two are required
  /// Why the document is issued despite a finding that it states, such as an expired calibration.
  struct Reason {
    std::string finding, text, by;  ///< id of the finding; reason; person who stated the reason
  };
  std::vector<Reason> reasons{};
  /// Unique identity of the register; the entry that assigned the number; digest of the register up
  /// to this entry.
  std::string register_id{}, register_entry{}, register_sha256{};
  bool is_draft() const { return number.empty(); }
};

/// Unique identifier of a certificate: its number and the digest of the readings.
inline std::string identifier_of(std::string_view number, std::string_view readings_sha256) {
  return std::string(number) + "." + std::string(readings_sha256);
}

struct Conformity {
  std::string measurement, axis, plugin, name;  ///< axis: empty unless the kind is "axis"
  double tolerance = 0.0;
  Quantity quantity = Quantity::deviation;
  Decision decision = Decision::cannot_be_decided;
  /// Why it is indeterminate: "no-uncertainty", "no-value" or "near-limit".
  std::string reason;
};

/// A model compared with the readings of one part of the machine, such as an axis. All values are
/// SI. Columns have one entry per reading, or none if the files do not contain them; the prediction
/// is deviation - residual.
struct ModelFit {
  /// The rms, smallest and largest value of a curve, m or rad.
  struct Curve {
    double rms = 0.0, low = 0.0, high = 0.0;
    /// Positions of `low` and `high` along the line, m or rad; std::nullopt in space, or if several
    /// positions have this value.
    std::optional<double> low_at{}, high_at{};
  };
  struct Parameter {
    std::string effect, name;  ///< effect and symbol: "backlash:X", "b"
    double value = 0.0;
    std::optional<double> u{};  ///< standard uncertainty, SI; std::nullopt if it is not known
    Quantity quantity = Quantity::number;
    /// Whether the value was found by a search over a nonlinear parameter: period, time constant,
    /// instant.
    bool searched = false;
  };
  struct Effect {
    std::string name;                  ///< "backlash:X"
    bool compensable = false;          ///< whether a table of the control can compensate it
    std::vector<double> contribution;  ///< predicted contribution to each reading, m or rad
    std::optional<Curve> curve{};
    bool is_set_up = false;  ///< of the set-up, not of the machine: in every model of such readings
  };
  /// An effect that is supported by the readings but not part of the model; m or rad.
  struct Candidate {
    std::string effect;
    double score = 0.0;  ///< twice the natural logarithm of the evidence for this effect
    double rms = 0.0;    ///< rms of the residuals with this effect in the model
    std::optional<double> cv_rms{};
    double p = 1.0;
    double smallest = 0.0;  ///< rms of an effect that is detected with probability 0.9
    /// Effects that these readings do not separate from this effect.
    std::vector<std::string> aliases;
    bool certain = false;  ///< whether it is significant, whatever causes the remaining residuals
  };
  /// One step of building the model. The first step has no effect; each further step adds the most
  /// effective of the remaining effects (above 20000 readings, the next one of the model).
  struct Step {
    std::string effect;  ///< effect that was added; empty for the first step
    double rms = 0.0;
    std::optional<double>
        cv_rms{};  ///< rms of cross-validation over runs; std::nullopt with one run
  };
  /// A temperature, speed or load that was recorded during the readings.
  struct Channel {
    std::string name, unit;      ///< "bearing", "degC"
    bool used = false;           ///< whether an effect of the model uses it
    std::vector<double> values;  ///< value at each reading, in `unit`
  };
  struct Suspect {
    std::size_t row = 0;
    double minimal_detectable = 0.0;  ///< smallest error that would be detected, m or rad
  };
  /// The fit of the model without one of its effects; members as those of the whole model.
  struct Without {
    std::string effect;
    double rms = 0.0;
    std::optional<double> cv_rms{};
    double largest = 0.0;
    std::vector<double> residual{}, weight{}, cv_residual{};
    std::optional<double> floor{}, floor_u{};
    std::vector<Suspect> suspects{};
  };

  std::string part;  ///< usable in a file name: "X"
  std::vector<std::string> measurements;
  std::string axis;
  bool rotary = false;   ///< whether positions are angles, rad
  bool angular = false;  ///< whether deviations are angles, rad
  /// Period of the drive: screw pitch in m, or rad between two teeth.
  std::optional<double> period{};

  std::vector<std::uint32_t> measurement;  ///< index into `measurements`
  std::vector<std::uint32_t> source_line;  ///< line of the file, 1-based
  std::vector<std::uint32_t> run;          ///< number of the run in the file, from 1
  std::vector<double> target;
  std::vector<std::int8_t> direction;  ///< direction of approach: +1, -1; 0 if not known
  std::vector<double> time;            ///< time of each reading, s; NaN where blank
  std::vector<double> temperature;     ///< material temperature, degC; NaN where blank
  double rms = 0.0;                    ///< rms of the residuals, m or rad
  std::optional<double> cv_rms{};      ///< rms of cross-validation over runs; absent with one run
  double largest = 0.0;  ///< residual with the largest absolute value, suspect readings excluded
  std::vector<double> deviation, residual;
  /// Weight from 0 to 1; a suspect reading has a small weight.
  std::vector<double> weight;
  /// Residual if the run is predicted from the other runs; empty with one run.
  std::vector<double> cv_residual;

  std::vector<Effect> effects;
  std::vector<Parameter> parameters;
  std::vector<std::vector<double>> correlation;  ///< correlation matrix of `parameters`
  std::vector<Step> steps;                       ///< the last step is the complete model
  /// Standard deviation of repeated readings, and its standard uncertainty.
  std::optional<double> floor{}, floor_u{};
  std::vector<Suspect> suspects;
  /// Verdict about the model, then findings about its residuals and the false-alarm rate.
  std::vector<Finding> diagnosis;
  std::vector<Without> without{};       ///< one fit for each effect that can be removed
  std::vector<Candidate> candidates{};  ///< ordered by evidence, largest first
  /// Effects without evidence, each with the smallest detectable size. Their texts form one
  /// sentence: "No sign of A (would be seen from 1 um)", "B (2 um)", ...
  std::vector<Finding> no_sign{};
  std::vector<Finding> next{};  ///< recommended further measurements
  std::vector<Channel> channels{};

  std::size_t size() const { return deviation.size(); }
};

/// All results of a campaign, which outputs use and results.json contains.
struct Results {
  struct Analysed {
    /// measurement: empty if the campaign as a whole was evaluated.
    std::string plugin, version, measurement;
    Evaluation evaluation;
    /// Name of the part of the model, such as "warm/z"; empty if `measurement` identifies it.
    std::string part{};
  };
  struct Written {
    std::string plugin, version;
    OutputResult result;  ///< includes the bytes of its files
  };
  std::vector<Error> errors;
  std::vector<Analysed> analyses;
  std::vector<ModelFit> models;
  std::vector<Conformity> conformity;
  std::vector<Written> outputs;
  std::vector<Remark> notes;
};

}  // namespace nonio
