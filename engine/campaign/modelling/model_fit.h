// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

/// The analysis of campaigns with a [model] in each run. It belongs to the host, because it needs
/// the effects of all plugins; its plugin name in results.json is "model-fit".
namespace nonio::modelling {

struct ModelFits {
  std::vector<Results::Analysed> analyses;
  std::vector<ModelFit> models;  ///< fits of the parts that could be fitted
};

/// Fits the model of each part with readings and returns it under the part's first measurement. A
/// model that cannot be fitted is a finding; a mistake in [model] effects is an error.
Expected<ModelFits> model_fit(const reading::ReadCampaign& read, const reading::Context& context);

/// Returns the readings of a part for documents without a model: the residuals are the readings.
ModelFit measured_value(const PartModel& part);

/// Returns a comparison for documents: readings, residuals, effects, parameters and noise floor,
/// without the results of an explanation.
ModelFit fitted_value(const PartModel& part, const model::Comparison& comparison);

/// Returns, for each effect of the model, the fit without it (as after `nonio model drop`); empty
/// for more than 20,000 readings, whose fits take seconds.
std::vector<ModelFit::Without> without_each(const PartModel& part);

/// Returns the readings from which tables are made if the manifest states compensate = "model": for
/// each target and direction that was measured, one reading, the sum of the model's compensable
/// effects. A measurement has no readings if its model has no such effect. Ball centres and
/// measurements that no model can explain stay unchanged. An error if a model cannot be fitted.
Expected<std::vector<Observations>> compensable_readings(const reading::ReadCampaign& read,
                                                         std::vector<Remark>& notes);

}  // namespace nonio::modelling
