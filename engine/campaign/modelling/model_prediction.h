// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/modelling/model_words.h"
#include "nonio/model/prediction.h"
#include "platform/storage/json_values.h"

/// Applies the model of one campaign to the readings of another campaign.
namespace nonio::modelling {

struct Predicted {
  PartModel seen, unseen;
  model::Prediction prediction;
};

/// Predicts every part of `unseen` that `seen` contains too, except ball centers. Only the zeros of
/// lines are fitted again. With `zero_kept`, displacements over time keep their zero, and other
/// parts are an error. An error if no part matches.
Expected<std::vector<Predicted>> predictions(const reading::ReadCampaign& seen,
                                             const reading::ReadCampaign& unseen, bool zero_kept);

/// Returns the JSON nonio-predict/1 (docs/json.md).
storage::Json predict_json(const std::vector<Predicted>& all, const Campaign& seen,
                           const Campaign& unseen, const ModelWords& words, bool zero_kept);

}  // namespace nonio::modelling
