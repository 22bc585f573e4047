// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/model_words.h"
#include "nonio/model/prediction.h"

/// Applies the model of one campaign to the readings of another campaign.
namespace nonio::modelling {

/// The prediction of one displacement in readings to which the model was not fitted.
struct Predicted {
  PartModel seen, unseen;
  model::Prediction prediction;
};

/// Returns a prediction for every displacement of `unseen` that `seen` contains too, matched by
/// measurement and name, otherwise by name. The model is that of the manifest of `seen`; only the
/// zero is fitted again, unless `zero_kept`. If no displacement matches, an error lists those of
/// both.
Expected<std::vector<Predicted>> predictions(const reading::ReadCampaign& seen,
                                             const reading::ReadCampaign& unseen, bool zero_kept);

/// Returns the JSON nonio-predict/1 (docs/json.md).
std::string predict_json(const std::vector<Predicted>& all, const Campaign& seen,
                         const Campaign& unseen, const ModelWords& words, bool zero_kept);

}  // namespace nonio::modelling
