// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/modelling/model_change.h"
#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/model_words.h"

namespace nonio::modelling {

/// Sentences about values below their uncertainty and effects that nothing here measures.
std::vector<std::string> warnings_of(const PartModel& part, const model::Fit& fit,
                                     const ModelWords& words);

/// What the page shows first goes without what a table would leave: that comes with the whole.
enum class Extent { whole, first };

/// One entry of "parts" in nonio-compare/1 and nonio-explain/1.
std::string part_json(const Compared& compared, const Campaign& campaign, const ModelWords& words,
                      Extent = Extent::whole);
std::string part_json(const Explained& explained, const Campaign& campaign,
                      const ModelWords& words);

/// docs/json.md: nonio-compare/1, nonio-explain/1 and nonio-model/1. Where `all` is empty, `errors`
/// state why; they and `warnings` are those of the campaign.
std::string compare_json(const std::vector<Compared>& all, const Campaign& campaign,
                         const ModelWords& words, const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors);
/// What one more run would do: `what_if` of nonio-explain/1.
std::string foresight_json(const std::vector<model::Foresight>& all);
std::string explain_json(const std::vector<Explained>& all, const Campaign& campaign,
                         const ModelWords& words, std::uint64_t seed,
                         const std::vector<ModelStep>& steps,
                         const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors);
std::string change_json(const Change& change, const Campaign& campaign, const ModelWords& words);

}  // namespace nonio::modelling
