// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

/// The nightly analysis of campaigns with a [model]. It belongs to the host, as it needs the
/// effects of all plugins; in results.json it has the plugin name "model-fit".
namespace nonio::modelling {

struct ModelFits {
  std::vector<Results::Analysed> analyses;
  std::vector<ModelFit> models;  ///< of those that could be fitted
};

/// One entry for each axis with readings, under its first measurement. A model that cannot be
/// fitted is a finding; one that names what does not exist is an error.
Expected<ModelFits> model_fit(const reading::ReadCampaign& read, const reading::Context& context);

/// The readings of a part as documents draw them, of no model: all that was measured is left.
ModelFit measured_value(const PartModel& part);

/// A comparison as documents draw it: readings, residuals, effects, parameters, noise floor; without
/// what an explanation adds.
ModelFit fitted_value(const PartModel& part, const model::Comparison& comparison);

/// As `nonio model drop` would leave it, for each effect of the model; none of more than 20,000
/// readings, whose fits take seconds.
std::vector<ModelFit::Without> without_each(const PartModel& part);

/// What a table takes where the manifest states compensate = "model": for each target and direction
/// that was measured, one reading that is the sum of the model's compensable effects. None of an
/// axis whose model has no such effect; measurements that are not of an axis stay as they are.
Expected<std::vector<Observations>> compensable_readings(const reading::ReadCampaign& read,
                                                         std::vector<Remark>& notes);

}  // namespace nonio::modelling
