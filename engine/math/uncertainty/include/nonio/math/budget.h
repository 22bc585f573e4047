// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nonio/sdk/budget.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// The uncertainty of whatever is fitted to readings: every analysis of several lines fills its
/// budget here.
///
/// A result f depends on the readings y_i with J_i = df/dy_i. An input quantity of standard
/// uncertainty u makes errors in the readings, and with them the error of f:
///
///     each reading its own      u_f^2 = u^2 sum_i J_i^2
///     a walk along a line       u_f^2 = u^2/(m - 1) sum_lines sum_k (sum_(i >= k) J_i)^2
///     one for a line            u_f^2 = u^2 sum_lines (sum_i J_i)^2,  or with J_i d_i
///     one for the instrument    u_f^2 = u^2 (sum_i J_i)^2,            or with J_i d_i
///
/// d_i: distance of reading i from the zero of its line, where the error grows with the length; m:
/// readings of a line (a mean of several visits: the walk goes through the visits). This is J V J'
/// with the covariance V of the readings; what one instrument has in common for all of them (its
/// scale) drops out of what does not depend on the scale. Where it is not known whether lines share
/// an error (a sensor that stays, a shop that is as warm for all lines) the larger one applies: one
/// for each line, or one for all.
///
/// Expanded: U = k u. k: the factor of 95.45 % of a normal and one rectangular part that have the
/// excess -1.2 sum c^4/u^4 of all rectangular parts c (2 without them, 1.65 of one alone), times
/// what Student's t needs more than 2 for the effective degrees of freedom
/// nu = u^4/sum(u_k^4/nu_k); only the repetition has finite ones.
///
/// Sources: JCGM 100:2008, 5.2 (correlated inputs), G.4 (Welch-Satterthwaite); the excess: the
/// fourth cumulants of independent parts add (derived); the inputs are those of uncertainty.h;
/// their correlations are ours (docs/uncertainty.md), checked by Monte Carlo according to JCGM 101
/// (bench/coverage.cpp).
namespace nonio::math {

/// Readings that share a zero, in the order of the walk.
struct BudgetLine {
  enum class Kind {
    length,      ///< of a beam: deviations along its line
    lateral,     ///< across it: straightness
    angle,       ///< rad
    coordinate,  ///< of the machine's own axis, probed
  };
  Kind kind = Kind::length;
  std::vector<double> length;         ///< of each reading, from the zero; m
  bool zeroed = false;                ///< its first reading is 0 by definition
  std::optional<double> expansion{};  ///< coefficient along the line, 1/K
  std::string expansion_keys{};       ///< that give it
  std::size_t group = 0;              ///< lines of one measurement have what a line has in common
  /// Of a fit whose residuals give the repetition: this line's readings are among them.
  bool in_residuals = true;
  /// Repetition of one reading, and its degrees of freedom, where lines differ in them.
  double u = 0.0, dof = INFINITY;
  /// Where readings are means: when the machine stopped there, and which part of the time counts.
  struct Visit {
    double time = 0.0;        ///< 0 at the first reading of the line, 1 at the last
    std::size_t reading = 0;  ///< of this line
    double weight = 1.0;      ///< in its mean
  };
  std::vector<Visit> visits{};  ///< by time; none: each reading once, one after the other
  /// Variance of one reading that a walk of variance 1 along the line shows in what the repetition
  /// was taken from.
  double walk_seen = 0.0;
};

/// Standard uncertainty in a result, of each input in the order of `inputs`.
struct Shares {
  std::vector<double> u;
  /// What the repetition shows of it: where each reading has its own, the part of it from lines
  /// that are in the residuals.
  std::vector<double> in_residuals;
  /// Fourth root of the sum of c^4 over its independent rectangular parts; none where normal.
  std::vector<double> rectangular{};
  double dof = 0.0;  ///< of the repetition, where the lines have one each; 0: as the budget states
};

/// What is known of the errors of readings, apart from their repeatability.
struct ReadingModel {
  struct Input {
    Contribution is;
    std::vector<double> of_line;  ///< standard uncertainty by line: m or rad, or for each m
    /// Of what is one for a line: the share of its variance that all lines have together; absent if
    /// it is not known.
    std::optional<double> together = 0.0;
    /// Standard uncertainty of one reading that shows in the residuals of a fit (see_residuals).
    double seen = 0.0;
    /// A length or coordinate that each reading has an error of its own of.
    bool of_each_reading() const;
    /// In place of these: independent errors of all readings, each a row of standard uncertainties.
    std::vector<std::vector<double>> patterns{};
  };
  std::vector<BudgetLine> lines;
  std::vector<Input> inputs;
  std::vector<std::string> missing;  ///< keys that are not stated

  std::size_t readings() const;
  /// row: derivative of a result by each reading, in the order of the lines.
  Shares shares(std::span<const double> row) const;
  /// Derivatives of the residuals of a fit by the readings, and their degrees of freedom: what the
  /// inputs make there is in the repetition that is taken from them.
  void see_residuals(std::span<const std::vector<double>> rows, double dof);
};

/// When each reading was taken, 0 to 1 over all of them: by their times, or else run by run, up and
/// then down. The order of the rows does not matter.
std::vector<double> reading_times(const Observations&);

/// The inputs as the manifest states them. Nothing is assumed for what it does not state.
ReadingModel reading_model(const Campaign&, const Environment&, std::vector<BudgetLine>);

/// Expansion of the machine along a direction: sum of c^2 alpha over the axes.
void put_expansion(BudgetLine&, const Campaign&, std::span<const std::string> axes,
                   std::span<const double> direction);

/// One result with its whole uncertainty.
struct Expanded {
  double u = 0.0;              ///< combined
  double k = 2.0;              ///< of U, or where that is not known of the repeatability
  double dof = INFINITY;       ///< effective
  std::optional<double> U;     ///< absent if a contribution was not stated
  double repeatability = 0.0;  ///< expanded, of the repetition alone
};

/// The budget of one evaluation while it is filled.
class BudgetOf {
 public:
  /// repetition: standard uncertainty of one reading, at most; dof: of it, infinite if stated;
  /// source: "readings", or the option that states it. Where it comes from the residuals of a fit
  /// (finite dof, and no line has a repetition of its own), they show what each reading has for
  /// itself: of inputs of that kind only the rest counts that the residuals do not show, the root
  /// of u^2 - repetition^2 of all of them. What else the scatter shows (drift, shapes that the fit
  /// does not take) counts once too: of these inputs only what is more than it.
  BudgetOf(const ReadingModel&, double repetition, double dof, Quantity quantity,
           std::string source = "readings");

  /// u_repetition: of this result.
  Expanded expand(double u_repetition, const Shares&) const;
  /// The same, as a value with U and k, or with its repeatability; noted in the budget.
  Value value(std::string name, double v, Quantity, double u_repetition, const Shares&);
  /// Uncertainty of a curve: one k for all of it, the largest.
  void put(Series&, std::span<const double> u_repetition, std::span<const Shares>) const;

  const UncertaintyBudget& budget() const { return budget_; }

 private:
  /// Of the inputs that count, in the order of the budget.
  std::vector<double> counted(double u_repetition, const Shares&) const;

  UncertaintyBudget budget_;
  std::vector<double> factor_;  ///< of each input, as far as it is in the residuals
  std::vector<bool> counts_;    ///< of each input: whether something of it is left
  std::vector<bool> each_;      ///< of each input: whether each reading has its own
  double unexplained_ = 0.0;    ///< of the variance of the repetition: not of such inputs
};

/// What the readings themselves show of limits that the manifest states: the larger one counts.
struct HeldLimits {
  Environment environment;
  std::vector<Finding> findings;  ///< one for each limit that the readings go beyond
};
HeldLimits limits_held(const Campaign&, std::span<const Observations* const>);

/// `uncertainty.no-data` with these keys.
Finding missing_finding(const std::vector<std::string>& keys);

/// Whether the instrument is stated to be exact, which none is; the key to state that.
std::optional<std::string> exact_instrument(const Instrument&, bool angular);

}  // namespace nonio::math
