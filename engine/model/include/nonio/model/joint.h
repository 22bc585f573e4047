// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/explain.h"

/// One search for missing effects over the same part of several campaigns. Every line keeps its own
/// zero and every campaign its own noise; an effect has one value, a value before and one after a
/// date, or a value in each campaign.
namespace nonio::model {

/// The part of one campaign, in the order of their dates.
struct Member {
  std::string campaign;
  const Part* part = nullptr;
  std::vector<Term> model;      ///< fitted with values of this campaign's own
  std::vector<Term> catalogue;  ///< what may be missing in it
};

enum class Holds {
  shared,   ///< the same value in all campaigns
  changed,  ///< one value up to a campaign, another one after it
  own,      ///< a value in each campaign
};

struct JointEffect {
  std::string effect;  ///< "backlash:X"
  Holds holds = Holds::shared;
  std::size_t after = 0;  ///< of changed: the first campaign with the second value
  /// Of shared one list, of changed two, of own one for each campaign (empty where its readings do
  /// not show the effect). Standard uncertainties.
  std::vector<std::vector<Parameter>> groups{};
  double evidence = 0.0;  ///< fall of -2 ln likelihood less the price of parameters and names
  double p = 1.0;         ///< corrected for the search
  double rms = 0.0;       ///< what this effect alone leaves in addition to the models, m or rad
  double size = 0.0;      ///< RMS of what it explains, m or rad
  std::vector<std::string> aliases{};  ///< as good in its place
};

struct JointExplanation {
  /// Of one campaign: RMS with its model, with what is named in addition; noise floor. m or rad.
  struct Campaign {
    std::size_t readings = 0;
    double rms = 0.0, rms_after = 0.0;
    std::optional<NoiseFloor> floor;
  };
  std::vector<Campaign> campaigns;
  std::vector<JointEffect> candidates;             ///< each alone, the best first
  std::vector<JointEffect> effects;                ///< named, in the order in which they were found
  double rms = 0.0, rms_after = 0.0, noise = 0.0;  ///< over all readings, m or rad
  Verdict::Kind verdict = Verdict::Kind::nothing;
  bool explains_all = true;  ///< of missing: what is named leaves no more than the noise
  double p_left = 1.0;       ///< chance of what is left after the effects that are named
  double trials = 1.0;       ///< independent tests that the search amounts to
};

/// Least squares over all members, each reading weighted by the noise floor of its campaign. Errors:
/// fewer than two members, a member without a noise floor whose model leaves no redundancy.
/// Evidence and chance as in `explain`: the signs of stretches and of whole passes of what is left
/// are flipped 200 times. Source: docs/dev/model-evidence.md, several campaigns.
Expected<JointExplanation> explain_together(const std::vector<Member>& members, std::uint64_t seed);

}  // namespace nonio::model
