// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/units.h"

namespace nonio {

/// A number with its name. In evidence the unit becomes part of the name: mean -> mean_um.
struct Number {
  std::string name;
  double value = 0.0;  ///< SI
  Quantity quantity = Quantity::number;
};

/// A result. What cannot be given is absent from the list, and a finding says why.
struct Value {
  std::string name;  ///< the standard's: A, R+, Ps_max
  double value = 0.0;
  Quantity quantity = Quantity::number;
  std::optional<double> U{};  ///< expanded uncertainty, k = 2
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

/// Something worth knowing that asks for nothing. Its words are the text `note.<id>` of
/// templates/words, with places as a finding has them; `english` is for plugins without words
/// there.
struct Remark {
  std::string id;
  std::vector<Number> evidence{};
  std::vector<std::pair<std::string, std::string>> texts{};
  std::string measurement{};
  std::string english{};
};

/// Values by target; NaN where one cannot be given.
struct PointTable {
  struct Column {
    std::string name;
    Quantity quantity = Quantity::number;
    std::vector<double> values;
  };
  std::vector<Column> columns;  ///< the first is `target`; all of the same length

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
};

/// What an analysis says of one measurement.
struct Evaluation {
  std::vector<Value> values;
  PointTable points;
  std::vector<Series> series;
  std::vector<Finding> findings;
  std::vector<Remark> notes;
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
};

/// What an output makes of a campaign. A refusal is a finding, not an error.
struct OutputResult {
  std::vector<Artifact> artifacts;
  std::vector<Prediction> predictions;
  std::vector<Finding> findings;
  std::vector<Remark> notes;  ///< what is only inferred about a format, for example
};

/// ISO 14253-1 with an upper limit.
enum class Decision { conforms, does_not_conform, cannot_be_decided };

/// One tolerance of the manifest held against one result.
struct Conformity {
  std::string measurement, axis, plugin, name;
  double tolerance = 0.0;
  Quantity quantity = Quantity::deviation;
  Decision decision = Decision::cannot_be_decided;
  std::string reason;  ///< why it cannot be decided: "no-uncertainty", "no-value", "near-limit"
};

/// Everything known of a campaign so far; what outputs read and results.json holds.
struct Results {
  struct Analysed {
    std::string plugin, version, measurement;
    Evaluation evaluation;
  };
  struct Written {
    std::string plugin, version;
    OutputResult result;  ///< artifacts with their names and bytes
  };
  std::vector<Error> errors;
  std::vector<Analysed> analyses;
  std::vector<Conformity> conformity;
  std::vector<Written> outputs;
  std::vector<Remark> notes;
};

}  // namespace nonio
