// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "campaign/config/fleet.h"
#include "campaign/modelling/model_words.h"
#include "platform/storage/json_values.h"

namespace nonio::modelling {

/// Adds "priors", the counts of the search, if it used any, and to a candidate its own "prior".
void put_priors(storage::Json& part, const config::Priors& priors, const ModelWords& words);
void put_prior(storage::Json& candidate, const std::string& effect, double weight,
               const config::Priors& priors, const ModelWords& words);
}  // namespace nonio::modelling
