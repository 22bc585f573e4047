// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/model/explain.h"

/// Combines the verdicts of the parts of a campaign: the most severe one, and the effects to add
/// next.
namespace nonio::modelling {

struct Explained {
  PartModel part;
  model::Explanation explanation;
  /// What one more run would change; none: not requested.
  std::optional<std::vector<model::Foresight>> what_if{};
};

/// Returns the index of the part with the most severe verdict: missing, unrepeatable, unknown,
/// nothing.
std::size_t most_severe(const std::vector<Explained>& all);

/// The verdict of one part. `next_effect` returns the effect that `nonio model explain --auto` adds
/// first: the missing effect of the most severe verdict, otherwise its most significant effect; ""
/// if there is none.
struct PartVerdict {
  std::string kind, effect;          ///< kind of the verdict, and the effect that it names
  std::vector<std::string> certain;  ///< significant effects, the one with the most evidence first
};
std::vector<PartVerdict> verdicts_of(const std::vector<Explained>& all);
std::string next_effect(const std::vector<PartVerdict>& parts);
/// Returns the effects that `--auto` adds next, as the manifest lists them; empty if there are
/// none.
std::vector<std::string> next_effects(const std::vector<Explained>& all);

const char* to_text(model::Verdict::Kind kind);

/// A pair of parameters whose correlation |r| is above 0.9.
struct Correlated {
  const model::Parameter *one, *other;
  double r;
};
std::vector<Correlated> correlated(const model::Fit& fit);

/// Largest number of candidates that the JSON marks as best, in addition to those of the best set.
inline constexpr std::size_t most_best = 5;

/// Whether a candidate has a score and can be ranked. These readings cannot show other candidates.
bool is_ranked(const model::Candidate& candidate);

}  // namespace nonio::modelling
