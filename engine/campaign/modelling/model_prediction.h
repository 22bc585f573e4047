// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/model_words.h"
#include "nonio/model/prediction.h"
#include "platform/storage/json_values.h"

/// Applies the model of one campaign to the readings of another campaign.
namespace nonio::modelling {

/// The prediction of one part of a campaign to whose readings the model was not fitted.
struct Predicted {
  PartModel seen, unseen;
  model::Prediction prediction;
};

/// Returns a prediction for every part of `unseen` that `seen` contains too, except ball centres.
/// Parts are matched by kind and name, displacements over time otherwise by displacement. The model
/// is that of the manifest of `seen`; only the zeros of the lines are fitted again. If `zero_kept`,
/// the zero of a displacement over time is kept too, and other parts are an error. If no part
/// matches, an error lists the parts of both campaigns.
Expected<std::vector<Predicted>> predictions(const reading::ReadCampaign& seen,
                                             const reading::ReadCampaign& unseen, bool zero_kept);

/// Returns the JSON nonio-predict/1 (docs/json.md).
storage::Json predict_json(const std::vector<Predicted>& all, const Campaign& seen,
                           const Campaign& unseen, const ModelWords& words, bool zero_kept);

}  // namespace nonio::modelling
