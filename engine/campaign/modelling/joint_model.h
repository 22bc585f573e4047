// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "campaign/modelling/model_words.h"
#include "nonio/model/joint.h"

namespace nonio::modelling {

/// The same axis in several campaigns, in the order of their dates, and what they show together.
struct Together {
  std::string part;  ///< "X"
  std::vector<std::string> campaigns, dates;
  std::vector<PartModel> parts;
  std::vector<std::string> effects;  ///< of the models of the campaigns
  model::JointExplanation explanation;
  std::vector<std::shared_ptr<const void>> keeps{};  ///< effects beyond those of the campaigns

  Quantity deviation() const { return parts.front().deviation(); }
};

/// Runs of each axis that two campaigns or more measured, with their own models. What cannot be
/// explained together (other parts, axes of one campaign) is named in `left_out`: "<campaign> <part>".
Expected<std::vector<Together>> explain_together(
    const std::vector<const reading::ReadCampaign*>& campaigns, std::uint64_t seed,
    std::vector<std::string>& left_out);

/// The part whose verdict asks most.
std::size_t most_severe(const std::vector<Together>& all);

/// One sentence: where the effect has which value.
std::string sentence_of(const model::JointEffect& effect, const Together& together,
                        const config::TerminalWords& say);
/// The verdict in one sentence.
std::string sentence_of(const Together& together, const config::TerminalWords& say);

/// docs/json.md: nonio-explain/1 of several campaigns.
std::string together_json(const std::vector<Together>& all, const config::TerminalWords& say,
                          std::uint64_t seed, const std::vector<std::string>& left_out,
                          const std::vector<Error>& errors);

}  // namespace nonio::modelling
