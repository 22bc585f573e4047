// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "campaign/modelling/model_words.h"
#include "nonio/model/joint.h"
#include "platform/storage/json_values.h"

namespace nonio::modelling {

/// One axis, and one side of a gantry, in several campaigns, by date, and the explanation of all
/// together. An axis before and after an adjustment is two members of one campaign.
struct Together {
  std::string axis, side;
  std::string part;  ///< axis and side; with the machine, if others are explained, too
  /// For each member; "before", "after" or "" for `adjustments`; `machines` may be empty texts.
  std::vector<std::string> campaigns, dates, adjustments, machines;
  std::vector<PartModel> parts;
  std::vector<std::string> effects;
  /// For each member, the standard uncertainty of a scale that its readings have in common.
  std::vector<std::optional<double>> u_scale;
  model::JointExplanation explanation;
  std::vector<std::shared_ptr<const void>> keeps{};  ///< owners of effects made from library causes

  Quantity deviation() const { return parts.front().deviation(); }
};

/// A part of one campaign that is explained on its own: an axis that no other campaign measured, a
/// circle, lines in space, a displacement over time; and the parts that a machine made, of all its
/// campaigns.
struct Alone {
  std::string campaign;
  PartModel part;
  /// Its plans separate what is named from its aliases; without values for each reading.
  model::Explanation explained{};
  /// Of parts that the machine made: of each reading with the effects found, and its standard
  /// deviation, m.
  std::vector<double> residual{};
  double noise = 0.0;
  /// Measurements of the part whose rows are in the order of machining, as they state.
  std::vector<std::string> ordered{};
};

struct FleetExplanation {
  /// Copies of campaigns that are explained in part or joined; terms refer to their effects.
  std::list<reading::ReadCampaign> made{};
  std::vector<Together> together;
  std::vector<Alone> alone;
  std::vector<std::string> differing{};  ///< campaigns whose parts do not fit one model: "a, b"
  std::vector<std::string> left_out;     ///< "<campaign> <part>", with the reason
};

/// Returns the names without repetitions, in their order.
std::vector<std::string> each_once(const std::vector<std::string>& names);

/// Explains together each axis that at least two campaigns of one machine, or of machines of one
/// stated model, measured, and alone what else has readings to plan for. Left out are parts with
/// more than 20000 readings other than displacements over time, and parts that cannot show their
/// model.
Expected<FleetExplanation> explain_together(
    const std::vector<const reading::ReadCampaign*>& campaigns, const config::Fleet& fleet,
    std::uint64_t seed);

/// Returns the JSON nonio-explain/1 of several campaigns (docs/json.md).
storage::Json together_json(const FleetExplanation& all, const ModelWords& words,
                            std::uint64_t seed, const std::vector<Error>& errors);

}  // namespace nonio::modelling
