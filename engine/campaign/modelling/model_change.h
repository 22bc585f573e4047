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

struct Change {
  ModelStep step;
  std::vector<std::string> effects;  ///< all effects of the model after the change
  /// nullopt if the model cannot be fitted or no measurement shows the effect.
  std::optional<Compared> before, after;
  std::string no_before;  ///< why the former model could not be fitted; otherwise empty
};

struct ModelEdit {
  std::string effect;
  bool add = true;
  std::string why{};  ///< comment for the history
  /// Part that the step compares; if empty, the first that shows the effect.
  std::string part{};
};
/// Returns removals first, then additions.
std::vector<ModelEdit> edits_between(const std::vector<std::string>& from,
                                     const std::vector<std::string>& to);

struct CampaignEdit {
  std::vector<ModelEdit> model{};
  std::vector<Exclusion> excluded{};
  std::vector<Period> periods{};
  std::string why{};  ///< comment on changes without their own

  bool empty() const { return model.empty() && excluded.empty() && periods.empty(); }
};
Expected<std::string> edited_manifest(std::string_view text, const CampaignEdit& edit);

/// Writes all changes with their history, or nothing. Effects are fitted after exclusions and
/// periods. `known`: comparison with the present model; may be null.
Expected<std::vector<Change>> change_campaign(const std::filesystem::path& folder,
                                              reading::ReadCampaign& read, const CampaignEdit& edit,
                                              const Compared* known = nullptr);

/// Changes campaign.toml and the history completely or not at all. `read` receives the new model.
Expected<Change> change_model(const std::filesystem::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add, const Compared* known = nullptr,
                              const std::string& part = {});

}  // namespace nonio::modelling
