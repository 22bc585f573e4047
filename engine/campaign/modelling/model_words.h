// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "campaign/config/terminal_words.h"
#include "campaign/modelling/campaign_model.h"
#include "nonio/model/prediction.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/templates.h"
#include "platform/storage/nearest.h"

/// Sentences about a model, from templates/words/<language>/model.toml.
namespace nonio::modelling {

/// Standard uncertainty of the scale of an axis that all readings of the part have in common;
/// nullopt if it is not stated.
std::optional<double> common_scale_uncertainty(const model::Part&, const Campaign&,
                                               const std::string& axis);

class ModelWords {
 public:
  ModelWords(const Templates& templates, std::string language)
      : templates_(templates), language_(std::move(language)) {}

  config::TerminalWords terminal() const { return {templates_, language_}; }

  /// States the RMS for readings that were not fitted.
  std::string prediction(const model::Prediction& p, const PartModel& part) const;
  std::string place(const model::Place& place, Quantity deviation) const;
  std::string statement(const model::Statement& statement, Quantity deviation) const;
  std::string verdict(const model::Explanation& explanation, const PartModel& part) const;
  std::string candidate(const model::Candidate& candidate, const PartModel& part,
                        double rms_before) const;
  std::string unseen(const model::Candidate& candidate, const RowsPlace& rows) const;
  std::string temperature_interpolated(const RowsPlace& rows) const;
  std::string cancelling(const std::string& one, const std::string& other) const;
  std::string plan(const model::Plan& plan) const;
  /// States the smallest detectable size of candidates without evidence; "" without candidates.
  std::string no_sign(const model::Explanation& explanation, const PartModel& part) const;
  /// Returns one sentence per proposed measurement.
  std::vector<std::string> next(const model::Explanation& explanation, const PartModel& part) const;
  std::string false_alarms(const model::Verdict& verdict) const;
  std::string lack_of_fit(const model::Comparison& comparison, Quantity deviation) const;
  /// Returns, for example, "RMS 0.7 um, from -1.1 um at 210 mm to 0.9 um at 640 mm".
  std::string curve(const ModelFit::Curve& curve, const PartModel& part) const;
  std::string suspect(const model::Suspect& suspect, const ReadingPlace& place,
                      Quantity deviation) const;
  std::string below_uncertainty(const std::string& effect) const;
  std::string gain_too_large(const model::Parameter& gain) const;
  /// `parameters`: number of parameters that are attributed to other effects.
  std::string not_identifiable(const std::string& effect, std::size_t parameters) const;
  std::string description(const model::Description&, const PartModel&) const;
  std::string order_assumed(const std::string& measurement) const;
  /// Returns differences from independent noise of constant scatter; may be empty.
  std::vector<std::string> noise(const model::Fit& fit, const PartModel& part) const;
  /// Returns sentences about channels that are not used, interrupted displacements, and time
  /// constants of thermal tests.
  std::vector<std::string> recordings(const PartModel& part, const model::Fit& fit) const;
  std::string order_unknown() const;
  /// u of a scale contains neither instrument nor temperatures: one sentence for each.
  std::vector<std::string> scales(const PartModel& part, const model::Fit& fit,
                                  const Campaign& campaign) const;
  std::string unstated_position(const std::vector<std::string>& measurements) const;
  std::string unstated_feed(const std::vector<std::string>& measurements) const;
  /// Where the angle of each squareness applies, if angular errors turn the same axis.
  std::vector<std::string> squareness_places(const model::Fit& fit) const;
  std::string unmeasured(const std::string& effect) const;
  /// `what` is "is", "size", "appearance", "similar" or "remedy". Returns English text without a
  /// translation, or "".
  std::string card(const std::string& effect, const std::string& what) const;

 private:
  std::string says(const std::string& id, std::vector<Number> numbers,
                   std::vector<std::pair<std::string, std::string>> texts) const;
  std::string differs(const model::Candidate& candidate) const;

  const Templates& templates_;
  std::string language_;
};

/// A share in whole percent.
Number percent(const char* name, double share);

/// Statements of `ModelWords` as findings, for documents in any language. Ids begin with
/// "verdict.", "place.", "plan.", "description." or "false-alarms".
Finding verdict_finding(const model::Explanation& explanation, const PartModel& part);
Finding place_finding(const model::Place& place, Quantity deviation);
Finding plan_finding(const model::Plan& plan);
Finding description_finding(const model::Description& description, const PartModel& part);
Finding false_alarms_finding(const model::Verdict& verdict);
Finding left_finding(const model::Comparison& comparison, Quantity deviation);
std::vector<Finding> no_sign_findings(const model::Explanation& explanation, const PartModel& part);
std::vector<Finding> next_findings(const model::Explanation& explanation, const PartModel& part);

/// Returns RMS, range and positions of the extremes; nullopt unless the term is a curve.
std::optional<ModelFit::Curve> curve_of(const PartModel& part, const model::Fit& fit,
                                        std::size_t term);

/// Returns " (D1)" for a place on one line; otherwise "".
std::string on_line(const model::Place& place);

/// Returns the place of the largest deviation, "12.5 mm" or "run 3"; "" if not known.
std::string where_largest(const model::Place& place, const std::string& language);

}  // namespace nonio::modelling
