// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/fit.h"
#include "nonio/sdk/campaign.h"

/// The model against the measurements: how well, where not, and which effect is missing.
/// docs/model.md has the statistics. Everything here is SI and free of words: people read
/// sentences made from it by templates/words.
namespace nonio::model {

/// Time constant with which a linear axis grows while it is exercised: of the thermal tests of the
/// campaign. Of first-order heating it is all that such a test and runs of the axis share: not the
/// amplitude and not the state of warmth (docs/model.md).
struct TimeConstant {
  enum class State {
    known,
    none,          ///< no test gives one
    contradictory  ///< two tests give different ones
  };
  std::string axis;
  std::vector<std::string> measurements;  ///< that give it; of `none` all
  State state = State::none;
  double tau = 0.0, u = 0.0;  ///< s
};

/// Time constants differ from so many standard uncertainties of the difference of their logarithms
/// on (docs/constants.md, M34).
inline constexpr double time_constants_apart = 2.6;

/// Measurements that are explained together: they sense the same axes in the same unit.
struct Part {
  enum class Kind {
    axis,   ///< runs of one axis, sensed along it
    space,  ///< several linear axes: their runs, straightness, diagonals, step diagonals
    balls   ///< centres of a ball that turns with a rotary axis: radial and axial, m
  };
  std::string name;                       ///< "X", "XY", "EYX", "C centres"
  std::vector<std::string> measurements;  ///< ids
  std::vector<Axis> axes;                 ///< one of an axis or balls; else the linear ones
  Observations table;                     ///< lines named by their measurements
  Kind kind = Kind::axis;
  std::vector<std::uint32_t> measurement{};  ///< of each reading: index into `measurements`
  std::vector<std::uint32_t> row{};          ///< of each reading: row of its measurement's table
  std::vector<double> along{};               ///< of each reading: its place on its line, m or rad
  std::vector<std::int8_t> way{};            ///< of each reading: +1 or -1 along its line
  /// Measurements of an axis whose file cannot be in the order in which it was measured: the cycle
  /// of ISO 230-2 is assumed.
  std::vector<std::string> order_assumed{};
  std::vector<TimeConstant> time_constants{};  ///< of its axes
};

/// Which shape of an effect is the time constant of a growth: continuous, named "tau", a time, beside
/// one growth per length.
std::optional<std::size_t> time_constant_shape(const Effect& effect);
/// Whether a term has the value that another measurement states.
bool has_stated(const Term& term);

/// A reading that was taken where the manifest does not say where the other axes stood.
inline bool stood_somewhere(const Part& part) {
  for (const auto& axis : part.table.axes)
    for (const double x : axis.position)
      if (!(x == x)) return true;
  return false;
}

/// What can be explained together, in the order of the measurements: runs of one axis; where
/// something is sensed across the axes or in several at once, all linear axes and their
/// measurements in one table; ball centres of a rotary axis. Others are left out, and so are
/// readings that `check` (sdk/check.h) refuses.
std::vector<Part> parts_of(const Campaign& campaign, const std::vector<Observations>& read);

/// All effects that apply to a part, without those that are always in a model.
std::vector<Term> catalogue(const Part& part, const std::vector<Effect>& effects);

/// The names that an effect has in this part: "backlash:X", "straightness:EYX".
std::vector<std::string> names_of(const Part& part, const Effect& effect);

/// The effects that a model names, then those that are always there, then its descriptions; an
/// unknown kind or axis is an error with the nearest name. Effects of axes that other parts hold
/// are left out.
Expected<std::vector<Term>> terms_of(const Part& part, const Machine& machine,
                                     const std::vector<std::string>& names,
                                     const std::vector<Effect>& effects);

/// Scatter of repeated readings of one target in one direction, after what a whole pass shares
/// (its own zero, slope and curvature) is taken out: no model of the catalogue is in it. Not below
/// what a display of coarse digits hides, digit/sqrt(12).
struct NoiseFloor {
  double s = 0.0;    ///< m or rad
  double u = 0.0;    ///< its standard uncertainty, s / sqrt(2 dof)
  double dof = 0.0;  ///< degrees of freedom
};

/// F-test of the model against the cell means: of the weighted residuals e of a fit of redundancy
/// dof1 + r, what exceeds the r degrees of freedom of the repeats and their floor s. Absent without
/// repeats.
///
///     F = (sum e^2 - r s^2)/(dof1 s^2)      dof2: that of s; F >= 0
struct LackOfFit {
  double F = 0.0, p = 1.0, dof1 = 0.0, dof2 = 0.0;
};

/// What readings are split by.
enum class Factor : char { direction, position, screw_phase, angle, run, time, temperature };

/// One factor, or the product of two.
struct Where {
  Factor first = Factor::direction;
  std::optional<Factor> second{};

  bool has(Factor f) const { return first == f || second == f; }
  bool operator==(const Where&) const = default;
};

/// "direction", "screw-phase"; of a product "direction x time".
std::string to_text(const Where& where);

/// Where something is left.
struct Place {
  Where where;
  double share = 0.0;  ///< of the sum of squares of what is left, less what noise would give
  double p = 1.0;      ///< F-test, corrected for the number of places looked at
  double rms = 0.0;    ///< of that part, m or rad
  /// Where it is largest, if it sits at one place: a target (m or rad), a run, an instant (s).
  std::optional<double> at{};
  Quantity at_quantity = Quantity::number;
  std::string line{};     ///< in space: "position" along this one
  bool together = false;  ///< of two factors: with what each of them says alone
};

/// A reading that contradicts its neighbours; kept, with weight 0, until the user excludes it.
struct Suspect {
  std::size_t row = 0;  ///< of the part's table
  double residual = 0.0;
  double t = 0.0;                   ///< studentised
  double minimal_detectable = 0.0;  ///< an error here below this would not have been seen, m or rad
};

struct Comparison {
  Fit fit;
  double largest = 0.0;  ///< largest residual in size, with its sign
  std::size_t largest_row = 0;
  std::optional<double> cv_rms{};     ///< of runs left out one at a time; absent with one run
  std::vector<double> cv_residual{};  ///< of each reading, predicted without its run
  std::optional<NoiseFloor> floor{};
  std::optional<LackOfFit> lack_of_fit{};
  std::vector<Place> places{};  ///< all that were looked at, largest share first
  /// Where something fails: the fewest places that hold what is left, each beside those before it,
  /// so that nothing is counted twice; no share below 2 %.
  std::vector<Place> seats{};
  std::size_t means = 0;  ///< long tables: of how many means the places tell; else 0
  std::vector<Suspect> suspects{};
  bool fails() const;  ///< something is left in some place
};

/// A place is said to fail below this p.
// docs/constants.md, M1.
inline constexpr double place_p = 0.01;

struct Candidate {
  Term term;            ///< with the shapes found
  bool visible = true;  ///< false: these readings cannot show it
  std::string why;      ///< if not: "aliased" with the model or the targets; "no-temperature", ...
  double rms = 0.0;     ///< with it added to the model
  std::optional<double> cv_rms{};
  double p = 1.0;      ///< chance that noise alone gives such a candidate anywhere in this search
  double score = 0.0;  ///< 2 ln of the evidence for it; <= 0: none
  std::vector<Parameter> parameters;
  std::vector<std::string> aliases;  ///< these readings cannot tell them from this one
  /// RMS of the smallest one that would be found nine times in ten, m or rad.
  double minimal_detectable = 0.0;
  /// Found near that size: an effect this large is found only where the noise makes it look so many
  /// times larger in the mean. 1 where that is nothing.
  double bias = 1.0;
  std::vector<std::uint32_t>
      rows{};  ///< not visible: rows of the part's table that stand in the way
  /// Descriptions of place beside which its evidence was found; else it is that beside the model.
  std::vector<std::string> beside{};
};

/// Effects that concern a part and do not apply to its readings, with the reason: not visible.
std::vector<Candidate> not_applying(const Part& part, const std::vector<Effect>& effects);

/// Rows of the table that have no temperature of their own, where it is interpolated in time.
std::vector<std::uint32_t> interpolated_temperatures(const Part& part);

/// A further measurement that would tell the effects of an alias group apart.
struct Plan {
  std::string id;            ///< "another-run", "run-after-a-pause", "other-targets", ...
  std::size_t readings = 0;  ///< to be taken
  double power = 0.0;        ///< distance of the two explanations in standard deviations
  std::string one, other;    ///< the two effects
  std::string of{};          ///< in space: the axes, or what is measured ("EYX")
};

/// What one run more would do to what is known if the noise stays as it is and the best explanation
/// is true (docs/model.md, "One run more").
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
};

/// A description added to the model, to what is certain and to those before it: what is left, not
/// why.
struct Description {
  enum class What { value_at_targets, reversal_at_targets, course };
  Term term;         ///< with the shapes found
  double rms = 0.0;  ///< what is left with it, m or rad
  What what = What::course;
  /// What it says, m or rad: of each target (values less their mean), else of each reading.
  double low = 0.0, high = 0.0, mean = 0.0;
};

struct Explanation {
  Comparison comparison;
  std::vector<Candidate> candidates;  ///< best first
  std::vector<std::string> together;  ///< what the best explanation adds to the model
  double best_rms = 0.0;              ///< what the best explanation leaves, m or rad
  /// Of these what is free of doubt, whatever the rest is; most evidence first.
  std::vector<std::string> certain;
  /// Pairs of effects of `together` that cancel each other: neither is shown by that.
  std::vector<std::pair<std::string, std::string>> cancelling;
  /// Growth and drift of `together` that are as well one growth away from this place on the axis,
  /// m.
  std::optional<double> one_growth{};
  double certain_rms = 0.0;               ///< unknown: with them in the model, m or rad
  std::vector<Description> descriptions;  ///< unknown: of what is left beside the certain
  std::vector<Place> fails;  ///< unknown: what the best explanation leaves; else the model's
  std::vector<Plan> plans;   ///< cheapest first; for the alias group of the verdict
  Verdict verdict;
};

/// What is found out of the readings before any model of them: how they repeat each other, which
/// are misread, how their noise hangs together. Kept where many models are held against the same
/// readings.
class Groundwork {
 public:
  /// Of `model` only the set-up counts.
  Groundwork(const Part& part, const std::vector<Term>& model);
  Groundwork(Groundwork&&) noexcept;
  ~Groundwork();
  struct Found;
  const Found& found() const { return *found_; }

 private:
  std::unique_ptr<const Found> found_;
};

/// Called once the fit of a long table is there, with all but its places.
using Fitted = std::function<void(const Comparison&)>;

/// Errors are those of `fit`: parameters that the readings cannot tell apart. `known`: of this
/// part, if it is there already.
Expected<Comparison> compare(const Part& part, const std::vector<Term>& model,
                             const Groundwork* known = nullptr, const Fitted& fitted = {});

/// `seed` is for the shuffles behind the false-alarm rate.
Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed = 1,
                              const Groundwork* known = nullptr);

/// One run more of an axis, in each direction order. Empty for other parts, and where nothing can
/// be said: no uncertainty, effects whose columns depend on all readings, too many readings.
std::vector<Foresight> foresee(const Part& part, const Explanation& e);

}  // namespace nonio::model
