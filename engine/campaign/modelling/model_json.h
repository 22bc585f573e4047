// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/modelling/model_change.h"
#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/model_words.h"
#include "platform/storage/json_values.h"

namespace nonio::modelling {

using storage::Json;

/// `part` (whose model has these parameters) and `terms` (of its fit) may be null.
Json parameters_json(const std::vector<model::Parameter>& parameters,
                     const PartModel* part = nullptr, const std::vector<model::Term>& terms = {});

/// `first`, which the page requests at first, omits the prediction after compensation by a table.
enum class Extent { whole, first };

/// Returns an entry of "parts" in nonio-compare/1 and nonio-explain/1.
std::string part_json(const Compared& compared, const Campaign& campaign, const ModelWords& words,
                      Extent = Extent::whole);
std::string part_json(const Explained& explained, const Campaign& campaign,
                      const ModelWords& words);

/// Return nonio-compare/1, nonio-explain/1 and nonio-model/1 (docs/json.md).
Json compare_json(const std::vector<Compared>& all, const Campaign& campaign,
                  const ModelWords& words, const std::vector<std::string>& warnings,
                  const std::vector<Error>& errors);
Json explain_json(const std::vector<Explained>& all, const Campaign& campaign,
                  const ModelWords& words, std::uint64_t seed, const std::vector<ModelStep>& steps,
                  const std::vector<std::string>& warnings, const std::vector<Error>& errors);
Json change_json(const Change& change, const Campaign& campaign, const ModelWords& words);
Json plan_json(const model::Plan& plan, const ModelWords& words);
Json steps_json(const std::vector<ModelStep>& steps);
/// Returns `parts`; without this member, a list of the document itself.
Json parts_of(const Json& document);
/// Returns `what_if` of nonio-explain/1.
std::string foresight_json(const std::vector<model::Foresight>& all);

}  // namespace nonio::modelling
