// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

/// Results of "model-fit", an analysis of the host because it needs the effects of all plugins.
namespace nonio::modelling {

struct ModelFits {
  std::vector<Results::Analysed> analyses;
  std::vector<ModelFit> models;  ///< parts that could be fitted
};

/// An error for a mistake in [model] effects; a model that cannot be fitted is a finding.
Expected<ModelFits> model_fit(const reading::ReadCampaign& read, const reading::Context& context);

/// For documents without a model: the residuals are the readings.
ModelFit measured_value(const PartModel& part);

/// For documents: the fit without an explanation.
ModelFit fitted_value(const PartModel& part, const model::Comparison& comparison);

/// Returns the fit without each effect; empty for more than 20000 readings.
std::vector<ModelFit::Without> without_each(const PartModel& part);

/// Returns the readings for tables with compensate = "model": one per target and direction, the sum
/// of the compensable effects. Ball centers and measurements without a model stay unchanged. An
/// error if a model cannot be fitted.
Expected<std::vector<Observations>> compensable_readings(const reading::ReadCampaign& read,
                                                         std::vector<Remark>& notes);

}  // namespace nonio::modelling
