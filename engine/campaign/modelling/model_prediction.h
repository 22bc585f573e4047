// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/model_words.h"
#include "nonio/model/prediction.h"

/// The model of one campaign applied to the readings of another one.
namespace nonio::modelling {

/// One displacement of the readings that the model has not seen.
struct Predicted {
  PartModel seen, unseen;
  model::Prediction prediction;
};

/// Every displacement of `unseen` that `seen` has too: by measurement and name, else by name alone.
/// The model is that of the manifest of `seen`; only the zero is new, unless `zero_kept`. None: an
/// error that names what both have.
Expected<std::vector<Predicted>> predictions(const reading::ReadCampaign& seen,
                                             const reading::ReadCampaign& unseen, bool zero_kept);

/// Schema nonio-predict/1 (docs/json.md).
std::string predict_json(const std::vector<Predicted>& all, const Campaign& seen,
                         const Campaign& unseen, const ModelWords& words, bool zero_kept);

}  // namespace nonio::modelling
