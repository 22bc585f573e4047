// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/modelling/campaign_model.h"
#include "host/modelling/model_history.h"

namespace nonio::host::modelling {

struct Compared {
  PartModel part;
  model::Comparison comparison;
};

/// What a change of the model does to the axis of its effect.
struct Change {
  ModelStep step;
  std::vector<std::string> effects;       ///< of the whole model, after it
  std::optional<Compared> before, after;  ///< absent where it could not be fitted
  std::string no_before;                  ///< why not
};

/// Adds an effect to campaign.toml or takes it out, and notes that in the history. Both files are
/// written whole or not at all; an effect is only added if the new model can be fitted. `read` then
/// has the new model.
Expected<Change> change_model(const std::filesystem::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add);

}  // namespace nonio::host::modelling
