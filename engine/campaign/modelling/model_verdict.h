// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/model/explain.h"

namespace nonio::modelling {

struct Explained {
  PartModel part;
  model::Explanation explanation;
  /// nullopt if not requested
  std::optional<std::vector<model::Foresight>> what_if{};
};

/// Order of severity: missing, unrepeatable, unknown, nothing.
std::size_t most_severe(const std::vector<Explained>& all);

/// `next_effect` returns the missing effect of the most severe verdict, otherwise its most
/// significant effect, or "".
struct PartVerdict {
  std::string kind, effect;          ///< `effect`: named by the verdict
  std::vector<std::string> certain;  ///< significant effects by decreasing evidence
};
std::vector<PartVerdict> verdicts_of(const std::vector<Explained>& all);
std::string next_effect(const std::vector<PartVerdict>& parts);
/// What is to be added next, in the form of the manifest, for the most severe part that is not one of
/// `settled`; `of` is null if nothing is.
struct NextEffects {
  const Explained* of = nullptr;
  std::vector<std::string> effects{};
};
NextEffects next_effects(const std::vector<Explained>& all, const std::set<std::string>& settled);
/// Effects, in the form of the manifest, whose values are below their uncertainties in each part
/// that has them, the weakest first.
std::vector<std::string> unproven_effects(const std::vector<Explained>& all);

const char* to_text(model::Verdict::Kind kind);

/// A pair of parameters whose correlation |r| is above 0.9.
struct Correlated {
  const model::Parameter *one, *other;
  double r;
};
std::vector<Correlated> correlated(const model::Fit& fit);

/// Largest number of best candidates in JSON, in addition to the best set.
inline constexpr std::size_t most_best = 5;

/// Whether the readings can show the candidate, so that a score exists.
bool is_ranked(const model::Candidate& candidate);

}  // namespace nonio::modelling
