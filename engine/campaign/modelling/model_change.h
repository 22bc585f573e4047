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

/// A change of the model and its effect on the part that shows the changed effect.
struct Change {
  ModelStep step;
  std::vector<std::string> effects;  ///< all effects of the model after the change
  /// Comparisons of the part before and after the change; none if the model cannot be fitted or no
  /// measurement shows the effect.
  std::optional<Compared> before, after;
  std::string no_before;  ///< why the former model could not be fitted; otherwise empty
};

/// An effect to add to a model, or to remove from it.
struct ModelEdit {
  std::string effect;
  bool add = true;
  std::string why{};  ///< comment of a person, which the history records
};
/// Returns the edits that lead from one model to another: removals first, then additions.
std::vector<ModelEdit> edits_between(const std::vector<std::string>& from,
                                     const std::vector<std::string>& to);

/// All changes of a campaign.toml that a person requests together.
struct CampaignEdit {
  std::vector<ModelEdit> model{};
  std::vector<Exclusion> excluded{};
  std::vector<Period> periods{};
  std::string why{};  ///< comment on all changes that have no comment of their own

  bool empty() const { return model.empty() && excluded.empty() && periods.empty(); }
};
/// Returns the text of a campaign.toml with all changes of `edit`. An error if a change is not
/// possible.
Expected<std::string> edited_manifest(std::string_view text, const CampaignEdit& edit);

/// Writes all changes, each with a line in the history, or writes nothing. Exclusions and periods
/// come first, so that effects are fitted to the remaining readings. `known` is a comparison of the
/// present model, if one already exists; otherwise null.
Expected<std::vector<Change>> change_campaign(const std::filesystem::path& folder,
                                              reading::ReadCampaign& read, const CampaignEdit& edit,
                                              const Compared* known = nullptr);

/// Adds an effect to campaign.toml or removes it, and records this in the history. Both files are
/// written completely or not at all; an effect is added only if the new model can be fitted. `read`
/// then contains the new model.
Expected<Change> change_model(const std::filesystem::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add, const Compared* known = nullptr);

}  // namespace nonio::modelling
