// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "campaign/modelling/model_change.h"
#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/model_words.h"

namespace nonio::modelling {

/// Returns the warnings about a fit as sentences: values below their uncertainty, gains that are
/// too large, parameters that are not identifiable, positions or orders that are not stated,
/// interpolated temperatures, time constants of thermal tests, and noise that is not independent or
/// not constant.
std::vector<std::string> warnings_of(const PartModel& part, const model::Fit& fit,
                                     const ModelWords& words);

/// Extent of an entry of "parts". With `first`, which the page requests at first, it omits the
/// prediction of what remains after compensation by a table.
enum class Extent { whole, first };

/// Returns an entry of "parts" in nonio-compare/1 and nonio-explain/1.
std::string part_json(const Compared& compared, const Campaign& campaign, const ModelWords& words,
                      Extent = Extent::whole);
std::string part_json(const Explained& explained, const Campaign& campaign,
                      const ModelWords& words);

/// Return the JSON nonio-compare/1, nonio-explain/1 and nonio-model/1 (docs/json.md). If `all` is
/// empty, `errors` state why; `errors` and `warnings` are those of the campaign.
std::string compare_json(const std::vector<Compared>& all, const Campaign& campaign,
                         const ModelWords& words, const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors);
/// Returns what one more run would change: `what_if` of nonio-explain/1.
std::string foresight_json(const std::vector<model::Foresight>& all);
std::string explain_json(const std::vector<Explained>& all, const Campaign& campaign,
                         const ModelWords& words, std::uint64_t seed,
                         const std::vector<ModelStep>& steps,
                         const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors);
std::string change_json(const Change& change, const Campaign& campaign, const ModelWords& words);

}  // namespace nonio::modelling
