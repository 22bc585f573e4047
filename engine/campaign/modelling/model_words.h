// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "campaign/config/terminal_words.h"
#include "campaign/modelling/campaign_model.h"
#include "nonio/model/prediction.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"
#include "platform/storage/nearest.h"

/// Returns sentences about a model, from templates/words/<language>/model.toml.
namespace nonio::modelling {

class ModelWords {
 public:
  ModelWords(const Templates& templates, std::string language)
      : templates_(templates), language_(std::move(language)) {}

  /// Returns labels and phrases for the terminal in the same language.
  config::TerminalWords terminal() const { return {templates_, language_}; }

  /// States how well a model predicts readings to which it was not fitted.
  std::string prediction(const model::Prediction& p, const PartModel& part) const;
  std::string place(const model::Place& place, Quantity deviation) const;
  std::string statement(const model::Statement& statement, Quantity deviation) const;
  std::string verdict(const model::Explanation& explanation, const PartModel& part) const;
  std::string candidate(const model::Candidate& candidate, const PartModel& part,
                        double rms_before) const;
  /// States why these readings cannot show an effect.
  std::string unseen(const model::Candidate& candidate, const RowsPlace& rows) const;
  std::string temperature_interpolated(const RowsPlace& rows) const;
  std::string channel_left(const model::ChannelLeft& left) const;
  /// States that two effects cancel each other, so that the readings show neither.
  std::string cancelling(const std::string& one, const std::string& other) const;
  std::string plan(const model::Plan& plan) const;
  /// Lists the candidates without evidence in one sentence, with the smallest size that would be
  /// detected; "" if there is none.
  std::string no_sign(const model::Explanation& explanation, const PartModel& part) const;
  /// States what to measure next, one sentence per proposal.
  std::vector<std::string> next(const model::Explanation& explanation, const PartModel& part) const;
  std::string false_alarms(const model::Verdict& verdict) const;
  std::string lack_of_fit(const model::Comparison& comparison, Quantity deviation) const;
  /// Returns the size of a curve in words, such as "RMS 0.7 um, from -1.1 um at 210 mm to 0.9 um at
  /// 640 mm".
  std::string curve(const ModelFit::Curve& curve, const PartModel& part) const;
  std::string suspect(const model::Suspect& suspect, const ReadingPlace& place,
                      Quantity deviation) const;
  std::string below_uncertainty(const std::string& effect) const;
  /// States that the gain of a channel is larger than any machine can have.
  std::string gain_too_large(const model::Parameter& gain) const;
  /// States how many parameters of a curve in space are attributed to other effects.
  std::string not_identifiable(const std::string& effect, std::size_t parameters) const;
  std::string description(const model::Description&, const PartModel&) const;
  std::string order_assumed(const std::string& measurement) const;
  /// States how the noise of a fit differs from independent noise of constant scatter; empty if it
  /// does not differ.
  std::vector<std::string> noise(const model::Fit& fit, const PartModel& part) const;
  /// States the time constants that thermal tests of the campaign determine for this part, one
  /// sentence per axis.
  std::vector<std::string> time_constants(const PartModel& part, const model::Fit& fit) const;
  std::string order_unknown() const;
  std::string has_unstated_position() const;
  std::string unmeasured(const std::string& effect) const;
  /// Returns the catalogue's text about an effect of this kind, in English if it is not translated;
  /// "" if there is none. `what` is "is", "size", "appearance", "similar" or "remedy".
  std::string card(const std::string& effect, const std::string& what) const;

 private:
  std::string says(const std::string& id, std::vector<Number> numbers,
                   std::vector<std::pair<std::string, std::string>> texts) const;
  /// Lists the values of an effect in each group of measurements, with U.
  std::string differs(const model::Candidate& candidate) const;

  const Templates& templates_;
  std::string language_;
};

/// Return the statements of `ModelWords` as findings, for documents in any language. The beginning
/// of an id names the statement: "verdict.", "place.", "plan.", "description.", "false-alarms".
Finding verdict_finding(const model::Explanation& explanation, const PartModel& part);
Finding place_finding(const model::Place& place, Quantity deviation);
Finding plan_finding(const model::Plan& plan);
Finding description_finding(const model::Description& description, const PartModel& part);
Finding false_alarms_finding(const model::Verdict& verdict);
/// States by how much the remaining deviations exceed the noise.
Finding left_finding(const model::Comparison& comparison, Quantity deviation);
std::vector<Finding> no_sign_findings(const model::Explanation& explanation, const PartModel& part);
std::vector<Finding> next_findings(const model::Explanation& explanation, const PartModel& part);

/// Returns RMS, range and positions of the extremes of the curve of a term; none if the term is not
/// a curve.
std::optional<ModelFit::Curve> curve_of(const PartModel& part, const model::Fit& fit,
                                        std::size_t term);

/// Returns " (D1)" for a place on one line; otherwise "".
std::string on_line(const model::Place& place);

/// Returns the position, run or time at which the deviations of a place are largest, "12.5 mm" or
/// "run 3"; "" if none of these is known.
std::string where_largest(const model::Place& place, const std::string& language);

}  // namespace nonio::modelling
