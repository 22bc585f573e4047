// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/model/comparison.h"

/// The model against the measurements: how well, where not, and which effect is missing.
/// docs/model.md has the statistics. Everything here is SI and free of words: people read
/// sentences made from it by templates/words.
namespace nonio::model {

/// Blocks of time that are left out of a course, one after the other.
inline constexpr int course_blocks = 6;

/// Gain of two metres of aluminium, m/K; docs/dev/constants.md, M40.
inline constexpr double most_per_kelvin = 50e-6;

struct Candidate {
  Term term;            ///< with the shapes found
  bool visible = true;  ///< false: these readings cannot show it
  std::string why;      ///< if not: "aliased" with the model or the targets; "no-temperature", ...
  double rms = 0.0;     ///< with it added to the model
  std::optional<double> cv_rms{};
  double p = 1.0;  ///< chance that noise alone gives such a candidate anywhere in this search
  /// 2 ln of the evidence for it; <= 0: none. By this they are ranked: where there is evidence both
  /// alone and within the best set, that alone, because an effect that leaves less comes first.
  double score = 0.0;
  double alone = 0.0;   ///< the same of it as the only addition to the model
  double within = 0.0;  ///< of one of the best set what is lost without it, else what it adds
  std::vector<Parameter> parameters;
  std::vector<std::string> aliases;  ///< these readings do not separate them from this one
  /// RMS of the smallest one that would be found nine times in ten, m or rad.
  double minimal_detectable = 0.0;
  /// Found near that size: an effect this large is found only where the noise makes it look so many
  /// times larger in the mean. 1 where that is nothing.
  double bias = 1.0;
  std::vector<std::uint32_t> rows{};  ///< not visible: rows of the part's table that prevent it
  /// Descriptions of position with which its evidence was found; empty: with the model alone.
  std::vector<std::string> with_descriptions{};
};

/// Effects that concern a part and do not apply to its readings, with the reason: not visible.
std::vector<Candidate> not_applying(const Part& part, const std::vector<Effect>& effects);

/// Rows of the table that have no temperature of their own, where it is interpolated in time.
std::vector<std::uint32_t> interpolated_temperatures(const Part& part);

/// A further measurement that would separate the effects of an alias group.
struct Plan {
  std::string id;            ///< "another-run", "run-after-a-pause", "other-targets", ...
  std::size_t readings = 0;  ///< to be taken
  double power = 0.0;        ///< distance of the two explanations in standard deviations
  std::string one, other;    ///< the two effects
  std::string of{};          ///< in space: the axes, or what is measured ("EYX")
};

/// What one more run would do to what is known if the noise stays as it is and the best explanation
/// is true (docs/dev/model-search.md, "One more run").
struct Foresight {
  struct Factor {  ///< by which the standard uncertainty of a parameter of the model is multiplied
    std::string effect, parameter;
    double factor = 1.0;
  };
  struct Evidence {  ///< `score` of an effect that the best explanation adds
    std::string effect;
    double now = 0.0, then = 0.0;
  };
  std::string id;            ///< as in Plan: "another-run", "another-run-reversed", ...
  std::size_t readings = 0;  ///< to be taken
  std::vector<Factor> parameters;
  std::vector<Evidence> evidence;
};

struct Verdict {
  enum class Kind { missing, nothing, unknown, unrepeatable };
  Kind kind = Kind::nothing;
  std::string effect;           ///< of missing
  double false_alarms = 0.0;    ///< share of shuffles of the noise whose verdict is not `nothing`
  std::size_t trials = 0;       ///< behind it
  double suspects_share = 0.0;  ///< of the readings
  /// unknown: less is left than the scatter of repeated readings allows.
  bool below_scatter = false;
};

/// A description added to the model, to what is certain and to those before it: what is left, not
/// why.
struct Description {
  enum class What { value_at_targets, reversal_at_targets, course };
  Term term;         ///< with the shapes found
  double rms = 0.0;  ///< what is left with it, m or rad
  What what = What::course;
  /// Its values, m or rad: of each target (values less their mean), else of each reading.
  double low = 0.0, high = 0.0, mean = 0.0;
};

/// What holds whatever repeats at each target from each side.
struct Statement {
  enum class What {
    drift,    ///< of the zero over the test, as a straight line
    reversal  ///< of one sign at every target
  };
  What what = What::drift;
  double value = 0.0, u = 0.0;   ///< of the whole drift; of the mean reversal, m or rad
  double low = 0.0, high = 0.0;  ///< of the reversals of the targets
  double p = 1.0;                ///< of reversals that of the least certain one, corrected
};

/// What recorded channels are worth to the model of a displacement over time and its best explanation.
struct Sensors {
  struct One {
    std::string channel;
    double rms_without = 0.0;  ///< of blocks that are left out, without its effects, m
  };
  std::size_t recorded = 0;           ///< channels in the file
  std::vector<One> used;              ///< the most needed first
  std::vector<std::string> smallest;  ///< with these it loses less than a tenth
  double rms = 0.0,
         rms_smallest = 0.0;  ///< of blocks that are left out, with all and with these, m
  /// A speed or load that acts through a part that no thermometer shows, and its time constant, s.
  std::string unseen{};
  double unseen_tau = 0.0;
  /// The gain that is known worst: effect, u/|gain|, and the duration of a test as varied as this one
  /// that would bring it to a tenth, s.
  std::string weakest{};
  double relative_u = 0.0, measured = 0.0, wanted = 0.0;
};

struct Explanation {
  Comparison comparison;
  std::vector<Candidate> candidates;  ///< best first
  std::vector<std::string> together;  ///< what the best explanation adds to the model
  bool explains_all = false;          ///< it leaves nothing in any place
  double best_rms = 0.0;              ///< what the best explanation leaves, m or rad
  /// Of these what is free of doubt, whatever the rest is; most evidence first.
  std::vector<std::string> certain;
  /// Pairs of effects of `together` that cancel each other: neither is shown by that.
  std::vector<std::pair<std::string, std::string>> cancelling;
  /// Growth and drift of `together` that are as well one growth away from this place on the axis,
  /// m.
  std::optional<double> one_growth{};
  double significant_rms = 0.0;           ///< unknown: with them in the model, m or rad
  std::vector<Description> descriptions;  ///< unknown: of what the significant effects leave
  std::vector<Statement> statements;      ///< unknown, of an axis
  std::vector<Place> fails;  ///< unknown: what the best explanation leaves; else the model's
  std::vector<Plan> plans;   ///< cheapest first; for the alias group of the verdict
  std::shared_ptr<const void> keeps{};  ///< effects that terms point into, beyond the catalogue's
  std::optional<Sensors> sensors{};     ///< over time, where effects of channels are in it
  Verdict verdict;
};

/// Of `terms` those that may replace an effect of the best explanation: what differs between
/// repeats does not replace what is the same in all of them, and the other way round.
std::vector<Term> replacing(const Part& part, const Explanation& e, std::vector<Term> terms);

/// `seed` is for the shuffles behind the false-alarm rate.
Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed = 1,
                              const Groundwork* known = nullptr);

/// One more run of an axis, in each direction order. Empty for other parts, and where nothing can
/// be stated: no uncertainty, effects whose columns depend on all readings, too many readings.
std::vector<Foresight> foresee(const Part& part, const Explanation& e);

}  // namespace nonio::model
