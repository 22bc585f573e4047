// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/model/explain.h"

/// The verdicts of the parts of a campaign together: which is the most severe, and what is to be
/// added to the model next.
namespace nonio::modelling {

struct Explained {
  PartModel part;
  model::Explanation explanation;
  std::optional<std::vector<model::Foresight>> what_if{};  ///< if it was requested
};

/// The part with the most severe verdict: missing, unrepeatable, unknown, nothing.
std::size_t most_severe(const std::vector<Explained>& all);

/// What belongs into the model beyond doubt, by the most severe verdict; "": nothing more. This is
/// one step of `nonio model explain --auto`.
struct PartVerdict {
  std::string kind, effect;          ///< of the verdict of one part
  std::vector<std::string> certain;  ///< most evidence first
};
std::vector<PartVerdict> verdicts_of(const std::vector<Explained>& all);
std::string next_effect(const std::vector<PartVerdict>& parts);
/// The effects that `--auto` adds next, as the manifest has them; empty: nothing more.
std::vector<std::string> next_effects(const std::vector<Explained>& all);

const char* to_text(model::Verdict::Kind kind);

/// Pairs of parameters with |r| beyond 0.9.
struct Correlated {
  const model::Parameter *one, *other;
  double r;
};
std::vector<Correlated> correlated(const model::Fit& fit);

/// Candidates that have a score, best first; the others are what these readings cannot show.
bool is_ranked(const model::Candidate& candidate);

}  // namespace nonio::modelling
