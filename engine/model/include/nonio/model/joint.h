// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/explain.h"

/// Joint search for missing effects in the same part of several campaigns. Every line has its own
/// zero, and every campaign its own noise.
namespace nonio::model {

/// The part of one campaign; members are sorted by date.
struct Member {
  std::string campaign, machine;
  const Part* part = nullptr;
  std::vector<Term> model;      ///< fitted with separate values for this campaign
  std::vector<Term> catalogue;  ///< terms that are searched
  std::vector<Term> found{};    ///< the noise is what they leave; they are searched all the same
};

enum class Holds {
  shared,   ///< the same value in all campaigns
  changed,  ///< one value up to some campaign, another value after it; only of one machine
  own,      ///< a separate value in each campaign
};

struct JointEffect {
  std::string effect;  ///< name of the effect: "backlash:X"
  Holds holds = Holds::shared;
  std::size_t after = 0;  ///< for `changed`: index of the first campaign with the second value
  /// One list for `shared`, two for `changed`, one per campaign for `own` (empty if its readings do
  /// not determine the effect). Only the first list contains the shapes.
  std::vector<std::vector<Parameter>> groups{};
  double weight = 1.0;    ///< weight in the search, by its frequency; not in evidence and p
  double evidence = 0.0;  ///< decrease of -2 ln likelihood minus the cost of parameters and names
  double p = 1.0;         ///< p-value of the effect; for named effects corrected for the search
  /// rms with this effect added to the models, for a named effect with all named effects, m or rad
  double rms = 0.0;
  double size = 0.0;  ///< rms of the part of the readings that this effect explains, m or rad
  /// effects that explain the readings equally well in its place
  std::vector<std::string> aliases{};
};

/// A further measurement of the machine of one campaign that would separate two effects.
struct JointPlan {
  std::size_t campaign = 0;  ///< index of the campaign whose readings the plan extends
  Plan plan;
};

struct JointExplanation {
  /// RMS with its model, RMS with the named effects in addition, noise floor; m or rad.
  struct Campaign {
    std::size_t readings = 0;
    double rms = 0.0, rms_after = 0.0;
    std::optional<NoiseFloor> floor;
    std::vector<double> residual{};  ///< of each reading with the named effects; NaN if not used
  };
  std::vector<Campaign> campaigns;
  std::vector<JointEffect> candidates;  ///< each as the only addition, the best first
  std::vector<JointEffect> effects;  ///< significant effects, in the order in which they were found
  /// For each named effect with aliases, of plans for at most eight campaigns: the one with enough
  /// power and the fewest readings, otherwise the one with the largest power.
  std::vector<JointPlan> plans{};
  /// All readings: RMS with the models, with the named effects in addition, of the noise; m or rad
  double rms = 0.0, rms_after = 0.0, noise = 0.0;
  Verdict::Kind verdict = Verdict::Kind::nothing;
  bool explains_all = true;  ///< whether the named effects leave only noise
  double p_left = 1.0;       ///< p-value of the residuals after the named effects
  double trials = 1.0;       ///< number of independent tests that the search is equivalent to
  /// If nothing is missing in all: an effect that one campaign shows and the others do not.
  struct Single {
    std::string effect;
    std::size_t campaign = 0;
    double p = 1.0;  ///< F-test, times the number of effects and campaigns
  };
  std::optional<Single> single{};
};

/// Least squares over all members; each reading is weighted by the noise floor of its campaign or,
/// if this has fewer than 8 degrees of freedom, by the residuals of its model. Errors: fewer than
/// two members, or readings of a member that do not scatter or do not determine its model. For
/// p-values, the signs of stretches and of whole passes of the residuals are flipped, 200 times in
/// all. Source: docs/dev/model-evidence.md, several campaigns.
Expected<JointExplanation> explain_together(const std::vector<Member>& members, std::uint64_t seed);

}  // namespace nonio::model
