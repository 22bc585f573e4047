// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "campaign/modelling/model_history.h"

namespace nonio::modelling {

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

/// An effect that comes into a model, or leaves it.
struct ModelEdit {
  std::string effect;
  bool add = true;
  std::string why{};  ///< comment of a person; goes into the history
};
/// What leads from one model to another: first what leaves, then what comes in.
std::vector<ModelEdit> edits_between(const std::vector<std::string>& from,
                                     const std::vector<std::string>& to);

/// What a person changes in a campaign.toml after looking at its model.
struct CampaignEdit {
  std::vector<ModelEdit> model{};
  std::vector<Exclusion> excluded{};
  std::vector<Period> periods{};
  std::string why{};  ///< of all of them; an exclusion has its own

  bool empty() const { return model.empty() && excluded.empty() && periods.empty(); }
};
/// The text of a campaign.toml after it.
Expected<std::string> edited_manifest(std::string_view text, const CampaignEdit& edit);

/// All of it is written, each change with its line of the history, or nothing. Exclusions and
/// periods come first, so that effects are fitted to what is left. `known`: the model as it is, compared with a part.
Expected<std::vector<Change>> change_campaign(const std::filesystem::path& folder,
                                              reading::ReadCampaign& read, const CampaignEdit& edit,
                                              const Compared* known = nullptr);

/// Adds an effect to campaign.toml or takes it out, and notes that in the history. Both files are
/// written whole or not at all; an effect is only added if the new model can be fitted. `read` then
/// has the new model.
Expected<Change> change_model(const std::filesystem::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add, const Compared* known = nullptr);

}  // namespace nonio::modelling
