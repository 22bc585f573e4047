// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "campaign/modelling/model_words.h"
#include "nonio/model/joint.h"

namespace nonio::modelling {

/// One axis in several campaigns, in the order of their dates, and the explanation of all together.
struct Together {
  std::string part;  ///< name of the part, which is that of its axis: "X"
  std::vector<std::string> campaigns, dates;
  std::vector<PartModel> parts;
  std::vector<std::string> effects;  ///< effects that the models of the campaigns contain
  model::JointExplanation explanation;
  std::vector<std::shared_ptr<const void>> keeps{};  ///< owners of effects made from library causes

  Quantity deviation() const { return parts.front().deviation(); }
};

/// Explains the runs of each axis that at least two campaigns measured, with the models of these
/// campaigns. Parts that cannot be explained together are added to `left_out` as "<campaign>
/// <part>": other kinds, axes that only one campaign measured and, with the reason in brackets,
/// parts that have more than 20000 readings or cannot show their model.
Expected<std::vector<Together>> explain_together(
    const std::vector<const reading::ReadCampaign*>& campaigns, std::uint64_t seed,
    std::vector<std::string>& left_out);

/// Returns the index of the part with the most severe verdict.
std::size_t most_severe(const std::vector<Together>& all);

/// Returns a sentence with the values of an effect in the campaigns.
std::string sentence_of(const model::JointEffect& effect, const Together& together,
                        const config::TerminalWords& say);
/// Returns the verdict as a sentence.
std::string sentence_of(const Together& together, const config::TerminalWords& say);

/// Returns the JSON nonio-explain/1 of several campaigns (docs/json.md).
std::string together_json(const std::vector<Together>& all, const config::TerminalWords& say,
                          std::uint64_t seed, const std::vector<std::string>& left_out,
                          const std::vector<Error>& errors);

}  // namespace nonio::modelling
