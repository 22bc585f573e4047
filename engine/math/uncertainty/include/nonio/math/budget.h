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

/// Uncertainty budget of results that are fitted to readings.
///
/// A result f depends on the readings y_i with J_i = df/dy_i. An input quantity of standard
/// uncertainty u causes errors in the readings, and thereby the error of f:
///
///     independent per reading    u_f^2 = u^2 sum_i J_i^2
///     random walk along a line   u_f^2 = u^2/(m - 1) sum_lines sum_k (sum_(i >= k) J_i)^2
///     common to a line           u_f^2 = u^2 sum_lines (sum_i J_i)^2,  or with J_i d_i
///     common to the instrument   u_f^2 = u^2 (sum_i J_i)^2,            or with J_i d_i
///
/// d_i: distance of reading i from the zero of its line, if the error grows with the length; m:
/// readings of a line (for means of several visits the random walk follows the visits). The sum of
/// all contributions is J V J' with the covariance V of the readings. An error that is common to
/// the instrument (its scale) cancels in results that do not depend on it. If it is not known
/// whether lines share an error, the larger value applies: independent per line, or common to all.
///
/// Expanded: U = k u. k: the factor for 95.45 % of a sum of a normal and one rectangular part with
/// the excess -1.2 sum c^4/u^4 of all rectangular parts c (2 without them, 1.65 for one alone),
/// times Student's t / 2 for nu = u^4/sum(u_k^4/nu_k); only the repetition has finite nu.
///
/// Sources: JCGM 100:2008, 5.2 (correlated inputs), G.4 (Welch-Satterthwaite); the excess is
/// derived; the correlations of the inputs are a laboratory method (docs/uncertainty.md).
namespace nonio::math {

/// Readings that share a zero, in the order of the random walk.
struct BudgetLine {
  enum class Kind {
    length,   ///< lengths measured by a beam, along the line
    lateral,  ///< deviations across the line: straightness
    angle,
    coordinate,  ///< coordinates of the machine's own axis, probed
  };
  Kind kind = Kind::length;
  std::vector<double> length;         ///< distance of each reading from the zero; m
  bool zeroed = false;                ///< whether its first reading is 0 by definition
  std::optional<double> expansion{};  ///< expansion coefficient of the machine along the line, 1/K
  std::string expansion_keys{};       ///< manifest key that is missing for `expansion`
  std::size_t group = 0;     ///< lines of one measurement share errors that are common to a line
  bool in_residuals = true;  ///< whether the residuals of a fit include those of this line
  /// Standard uncertainty of a reading by repetition, and its degrees of freedom, if lines differ.
  double u = 0.0, dof = INFINITY;
  /// For readings that are means: one stop of the machine that contributes to a reading.
  struct Visit {
    double time = 0.0;  ///< 0 at the first reading of the line, 1 at the last
    std::size_t reading = 0;
    double weight = 1.0;
  };
  std::vector<Visit> visits{};  ///< sorted by time; empty: each reading once, one after the other
  /// Variance by a random walk with variance 1 along the line in the readings of the repetition.
  double walk_seen = 0.0;
};

/// Standard uncertainty in a result by each input, in the order of `inputs`.
struct Shares {
  std::vector<double> u;
  /// The part of `u` that is already contained in the repetition: for inputs that are independent
  /// per reading, the part from lines whose readings are in the residuals.
  std::vector<double> in_residuals;
  /// Fourth root of the sum of fourth powers of independent rectangular parts of `u`; otherwise 0.
  std::vector<double> rectangular{};
  /// degrees of freedom of the repetition, if lines differ; 0: those of the budget
  double dof = 0.0;
};

/// Errors of the readings except their repetition.
struct ReadingModel {
  struct Input {
    Contribution is;
    std::vector<double> of_line;  ///< standard uncertainty by line: m or rad, or per m of length
    /// Fraction of a line's common variance that all lines share; absent if it is not known.
    std::optional<double> together = 0.0;
    /// Standard uncertainty of a reading by this input in the residuals of a fit (see_residuals).
    double seen = 0.0;
    /// Whether the error is one of a length or coordinate and independent per reading.
    bool of_each_reading() const;
    /// If not empty, replaces the correlation: independent errors, each as the standard
    /// uncertainties that it causes in all readings.
    std::vector<std::vector<double>> patterns{};
  };
  std::vector<BudgetLine> lines;
  std::vector<Input> inputs;
  std::vector<std::string> missing;

  std::size_t readings() const;
  /// `row`: derivative of the result by each reading, in the order of the lines.
  Shares shares(std::span<const double> row) const;
  /// Computes `Input::seen`. `rows`: derivatives of the residuals of a fit by the readings; `dof`:
  /// their degrees of freedom.
  void see_residuals(std::span<const std::vector<double>> rows, double dof);
};

/// Times of the readings, 0 to 1; without complete times run by run, up and then down.
std::vector<double> reading_times(const Observations&);

/// Returns the inputs that the manifest states. Nothing is assumed for missing keys.
ReadingModel reading_model(const Campaign&, const Environment&, std::vector<BudgetLine>);

/// Sets the expansion coefficient along `direction` with components c: the sum of c^2 alpha over
/// the axes. If one is not stated, only `expansion_keys` is set, to the first missing key.
void put_expansion(BudgetLine&, const Campaign&, std::span<const std::string> axes,
                   std::span<const double> direction);

struct Expanded {
  double u = 0.0;              ///< combined standard uncertainty
  double k = 2.0;              ///< coverage factor of U, or of the repeatability if U is absent
  double dof = INFINITY;       ///< effective degrees of freedom
  std::optional<double> U;     ///< absent if a contribution was not stated or u is 0
  double repeatability = 0.0;  ///< expanded uncertainty by repetition alone
};

class BudgetOf {
 public:
  /// `repetition`: largest standard uncertainty of one reading; `dof`: its degrees of freedom,
  /// infinite if stated; `source`: "readings", or the option that states it. A repetition from the
  /// residuals of a fit (finite dof) already contains a part of the other inputs; of these inputs,
  /// only the excess over this part is added.
  BudgetOf(const ReadingModel&, double repetition, double dof, Quantity quantity,
           std::string source = "readings");

  /// `u_repetition`: standard uncertainty of this result by repetition.
  Expanded expand(double u_repetition, const Shares&) const;
  /// Records the value with U and k in the budget. If U is not known, the value has its
  /// repeatability instead and is not recorded.
  Value value(std::string name, double v, Quantity, double u_repetition, const Shares&);
  /// Sets U of each point of a curve, or its repeatability if a contribution was not stated. All
  /// points have the same coverage factor, the largest of all.
  void put(Series&, std::span<const double> u_repetition, std::span<const Shares>) const;

  const UncertaintyBudget& budget() const { return budget_; }

 private:
  std::vector<double> counted(double u_repetition, const Shares&) const;

  UncertaintyBudget budget_;
  std::vector<double> factor_;  ///< for each input: fraction of u that the residuals do not contain
  std::vector<bool> counts_;    ///< for each input: whether it is in the budget
  std::vector<bool> each_;      ///< for each input: whether it is independent per reading
  /// fraction of the repetition's variance that inputs independent per reading do not explain
  double unexplained_ = 0.0;
};

/// Limits of the manifest, replaced by larger values found in the readings.
struct HeldLimits {
  Environment environment;
  std::vector<Finding> findings;  ///< one for each limit that the readings exceed
};
HeldLimits limits_held(const Campaign&, std::span<const Observations* const>);

Finding missing_finding(const std::vector<std::string>& keys);

/// Manifest key that states an instrument without uncertainty, which is not possible.
std::optional<std::string> exact_instrument(const Instrument&, bool angular);

}  // namespace nonio::math
