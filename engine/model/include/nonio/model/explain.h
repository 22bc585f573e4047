// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/model/comparison.h"

/// docs/model.md describes the statistics. All values are SI; the texts are in templates/words.
namespace nonio::model {

/// Number of blocks of time into which a course is divided for cross-validation.
inline constexpr int course_blocks = 6;

/// Largest plausible displacement per kelvin of a channel, that of two meters of aluminum, m/K;
/// docs/dev/constants.md, M40.
inline constexpr double most_per_kelvin = 50e-6;

struct Candidate {
  Term term;            ///< the effect with the shapes found
  bool visible = true;  ///< whether the effect is identifiable from these readings
  /// reason if not visible: "not-shown" by these readings, "aliased" with the model or the targets,
  /// or the id that the effect states, such as "no-temperature"
  std::string why;
  double rms = 0.0;  ///< rms of the residuals with the effect added to the model, m or rad
  std::optional<double> cv_rms{};
  double p = 1.0;  ///< probability that noise alone gives such a candidate anywhere in this search
  /// 2 ln of the evidence plus that of the weight (`Term::weight`), by which candidates are ranked
  /// after those that have evidence alone; <= 0: no evidence. With evidence both alone and within
  /// the best set, it is that of `alone` (for a course the larger one).
  double score = 0.0;
  double alone = 0.0;  ///< 2 ln of the evidence as the only addition to the model
  /// 2 ln of the evidence that the best set loses without this member, or gains if this effect is
  /// added or replaces a member
  double within = 0.0;
  std::vector<Parameter> parameters;
  std::vector<std::string> aliases;  ///< effects that these readings do not separate from this one
  /// RMS of the smallest effect that is detected with probability 0.9, m or rad; NaN for a course.
  double minimal_detectable = 0.0;
  /// Mean ratio of found to true size near the limit of detection; 1 without bias.
  double bias = 1.0;
  std::vector<std::uint32_t> rows{};  ///< rows of the part's table that are the reason `why`
  /// Descriptions of position in the model with which the evidence was found; empty if there was
  /// none.
  std::vector<std::string> with_descriptions{};
};

/// Effects that concern a part but are not identifiable from its readings, with the reason.
/// Nuisances, descriptions and effects that give no reason are omitted.
std::vector<Candidate> not_applying(const Part& part, const std::vector<Effect>& effects);

std::vector<std::uint32_t> interpolated_temperatures(const Part& part);

/// Standard deviations between two separable explanations: docs/dev/constants.md, M13.
inline constexpr double enough_power = 4.0;

/// A further measurement that would separate the effects of an alias group.
struct Plan {
  /// kind of measurement: "another-run", "run-after-a-pause", "other-targets", ...
  std::string id;
  std::size_t readings = 0;
  double power = 0.0;      ///< distance of the two explanations in standard deviations
  std::string one, other;  ///< names of the two effects
  /// in space axes of the plan, or what is measured ("EYX"); over time the speed that changes
  std::string of{};
  /// Duration including the pause before the measurement, s; only for readings with times.
  std::optional<double> duration{};
  std::optional<double> every{};  ///< time between changes of the speed or load `of`, s

  bool separates() const { return power >= enough_power; }
};

/// Whether `a` is to be advised before `b`: plans that separate by increasing duration, then those of
/// unknown duration by their number of readings, then the others by decreasing power.
bool is_better(const Plan& a, const Plan& b);

/// Predicted improvement by one more run, if the noise stays as it is and the best explanation is
/// true (docs/dev/model-search.md, "One more run").
struct Foresight {
  struct Factor {  ///< ratio of the standard uncertainty of a parameter with and without the run
    std::string effect, parameter;
    double factor = 1.0;
  };
  struct Evidence {  ///< `score` of an effect of the best explanation, without and with the run
    std::string effect;
    double now = 0.0, then = 0.0;
  };
  std::string id;  ///< kind of measurement as in Plan: "another-run", "another-run-reversed", ...
  std::size_t readings = 0;
  std::vector<Factor> parameters;
  std::vector<Evidence> evidence;
};

struct Verdict {
  enum class Kind { missing, nothing, unknown, unrepeatable };
  Kind kind = Kind::nothing;
  std::string effect;
  /// share of noise samples with a verdict other than `nothing`; for a course a significance level
  double false_alarms = 0.0;
  std::size_t trials = 0;       ///< number of simulated noise samples
  double suspects_share = 0.0;  ///< share of the readings that are suspect
  /// For `unknown`: the residuals are smaller than the scatter of repeated readings allows.
  bool below_scatter = false;
};

/// Shape of the residuals that significant effects and earlier descriptions leave, not their cause.
struct Description {
  enum class What { value_at_targets, reversal_at_targets, course };
  Term term;
  double rms = 0.0;  ///< rms of the residuals with the description in the model, m or rad
  What what = What::course;
  /// Smallest and largest value minus the mean (for reversals: the values themselves), and the
  /// mean, m or rad: over targets, or for a course over readings.
  double low = 0.0, high = 0.0, mean = 0.0;
};

/// A statement that is true for any error that repeats at each target from each side.
struct Statement {
  enum class What {
    drift,    ///< drift of the zero over the test, as a straight line
    reversal  ///< reversal with the same sign at every target
  };
  What what = What::drift;
  /// total drift or mean reversal, and its standard uncertainty, m or rad
  double value = 0.0, u = 0.0;
  double low = 0.0, high = 0.0;  ///< smallest and largest reversal of a target, m or rad
  /// p-value; for reversals that of the least significant target, corrected for their number
  double p = 1.0;
};

/// Contribution of recorded channels to the explanation of a displacement over time.
struct Sensors {
  struct One {
    std::string channel;
    double rms_without = 0.0;  ///< RMS of cross-validation without the effects of this channel, m
  };
  std::size_t recorded = 0;  ///< number of channels in the file
  std::vector<One> used;     ///< channels used, the most needed first
  /// smallest set of channels with which the RMS grows by at most a tenth
  std::vector<std::string> smallest;
  /// RMS of cross-validation with all channels, and with the smallest set, m
  double rms = 0.0, rms_smallest = 0.0;
  /// A speed or load that acts through a part without a temperature sensor; its time constant, s.
  std::string unseen{};
  double unseen_tau = 0.0;
  /// Effect of the gain with the largest u/|gain|; this ratio; duration of this test, and of an
  /// equally varied test that would reduce the ratio to 0.1, s.
  std::string weakest{};
  double relative_u = 0.0, measured = 0.0, wanted = 0.0;
};

/// An effect of the model and the effects that explain these readings as well in its place.
struct Replaceable {
  std::string effect;
  std::vector<std::string> by;
};

struct Explanation {
  Comparison comparison;
  /// effects that can be added to the model, largest evidence first
  std::vector<Candidate> candidates;
  std::vector<std::string> together;  ///< effects that the best explanation adds to the model
  /// for `missing`: whether the best explanation leaves no significant structure or lack of fit
  bool explains_all = false;
  double best_rms = 0.0;  ///< rms of the residuals of the best explanation, m or rad
  /// Effects that are significant whatever causes the residuals: those of `together` and, for
  /// `unknown`, those found with descriptions in the model.
  std::vector<std::string> certain;
  /// Pairs of effects of `together` that cancel each other, so that neither is demonstrated.
  std::vector<std::pair<std::string, std::string>> cancelling;
  /// for `nothing`: effects of the model whose values these readings cannot prove, because others
  /// explain them as well
  std::vector<Replaceable> replaceable;
  /// A growth and a drift in `together` that are one growth about the point `at`, m.
  struct OneGrowth {
    std::string growth, drift;
    double at = 0.0;
  };
  std::optional<OneGrowth> one_growth{};
  /// for `unknown`: rms with the significant effects, m or rad; for a course `best_rms`
  double significant_rms = 0.0;
  /// if the verdict is `unknown`: descriptions of the residuals that the significant effects leave
  std::vector<Description> descriptions;
  /// for `unknown` on an axis: statements that are true for any error that repeats at each target
  std::vector<Statement> statements;
  /// places of the structure in the residuals of the model; for `unknown` the smallest set of
  /// places that contains it or, if none does, the places of the best explanation
  std::vector<Place> fails;
  /// at most three measurements that would separate aliases (for `nothing` those of the first of
  /// `replaceable`), or two effects that cancel each other; for a course one for each alias
  /// of the named effect and of those of `certain`
  std::vector<Plan> plans;
  /// owner of effects that are not in the catalog but are referenced by terms
  std::shared_ptr<const void> keeps{};
  /// for a course with effects of channels in its model or in its best explanation
  std::optional<Sensors> sensors{};
  Verdict verdict;
};

/// Terms that could replace an effect of the best explanation. An effect that differs between
/// repeats cannot replace one that is the same in all of them, nor the reverse.
std::vector<Term> replacing(const Part& part, const Explanation& e, std::vector<Term> terms);

/// `seed`: for the simulated noise that determines the false-alarm rate; `known`: as in `compare`.
Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed = 1,
                              const Groundwork* known = nullptr);

/// Predicts the effect of one more run of an axis, for each order of directions. Empty for other
/// parts, without uncertainties, for more than 20,000 readings, and if more readings change the
/// columns of an effect for the present ones.
std::vector<Foresight> foresee(const Part& part, const Explanation& e);

}  // namespace nonio::model
