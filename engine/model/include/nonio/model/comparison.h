// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/measurements.h"

namespace nonio::model {

/// Standard deviation of repeated readings of one target in one direction: of the residuals without
/// the mean of each target and direction and the terms of a whole pass (zero, slope, curvature). At
/// least digit/sqrt(12); for a course from second differences of the residuals.
struct NoiseFloor {
  double s = 0.0;  ///< standard deviation, m or rad
  double u = 0.0;  ///< standard uncertainty of s, including an uncertain correlation of readings
  double dof = 0.0;
};

/// F-test of the model against the cell means, with the weighted residuals e of a fit of redundancy
/// dof1 + r, the r degrees of freedom of repeated readings, and their standard deviation s of dof2
/// degrees of freedom. Absent if r < 3 or dof1 < 1.
///
///     F = (sum e^2 - r s^2)/(dof1 s^2)      F >= 0
struct LackOfFit {
  double F = 0.0, p = 1.0, dof1 = 0.0, dof2 = 0.0;
};

/// The properties of readings by which residuals are grouped.
enum class Factor : char {
  direction,
  position,
  screw_phase,
  angle,
  run,
  time,
  temperature,
  measurement,
  channel
};

/// One factor, or the product of two.
struct Where {
  Factor first = Factor::direction;
  std::optional<Factor> second{};

  bool has(Factor f) const { return first == f || second == f; }
  bool operator==(const Where&) const = default;
};

/// For example "direction", "screw-phase", or for a product "direction x time".
std::string to_text(const Where& where);

/// A structure that remains in the residuals, by the factor with which it varies.
struct Place {
  Where where;
  /// share of the residual sum of squares; in `Comparison::places` minus that expected from noise
  double share = 0.0;
  /// p-value of an F-test, or of a t-test of one target or run; corrected for the number of places
  double p = 1.0;
  double rms = 0.0;
  /// Main position, if any: a target (m or rad), the number of a run, or an instant (s).
  std::optional<double> at{};
  Quantity at_quantity = Quantity::number;
  /// in space: name of the line of this position; for `channel`: name of the channel
  std::string line{};
  /// for two factors: whether `share` includes the effect of each factor alone
  bool together = false;
};

/// A reading that contradicts other readings; its weight is 0 until the user excludes it.
struct Suspect {
  std::size_t row = 0;
  double residual = 0.0;
  double t = 0.0;                   ///< studentized residual
  double minimal_detectable = 0.0;  ///< smallest detectable error of this reading, m or rad
};

struct Comparison {
  Fit fit;
  /// residual with the largest absolute value, with its sign, m or rad; suspect readings excluded
  double largest = 0.0;
  std::size_t largest_row = 0;
  /// RMS of cross-validation over runs, or over blocks of time for a course, m or rad
  std::optional<double> cv_rms{};
  /// residual of each reading when its run is predicted from the others, m or rad; NaN if they do
  /// not determine it; empty with one run and for a course
  std::vector<double> cv_residual{};
  std::optional<NoiseFloor> floor{};
  std::optional<LackOfFit> lack_of_fit{};
  std::vector<Place> places{};  ///< all tested places, largest share first
  /// If the model fails: the smallest set of at most three places that contains the residuals. The
  /// share of each place is in addition to the shares of those before it, and is at least 2 %.
  std::vector<Place> seats{};
  std::size_t means = 0;  ///< number of means on which places were tested; 0 for short tables
  std::vector<Suspect> suspects{};
  bool fails() const;  ///< whether a significant structure remains in some place
};

/// A model does not fit in a place whose p is below this value; docs/dev/constants.md, M1.
inline constexpr double place_p = 0.01;

/// Properties of the readings that do not depend on a model: repeats, suspects, and correlation of
/// the noise. They are computed once if many models are compared with the same readings.
class Groundwork {
 public:
  /// Only the set-up terms of `model` are used.
  Groundwork(const Part& part, const std::vector<Term>& model);
  Groundwork(Groundwork&&) noexcept;
  ~Groundwork();
  struct Found;
  const Found& found() const { return *found_; }

 private:
  std::unique_ptr<const Found> found_;
};

/// Called by `compare` for a long table after the fit, before places are tested.
using Fitted = std::function<void(const Comparison&)>;

/// Errors: no readings, or those of `fit`. `known`: the groundwork of this part, if it exists.
/// `fitted`: called for a long table only.
Expected<Comparison> compare(const Part& part, const std::vector<Term>& model,
                             const Groundwork* known = nullptr, const Fitted& fitted = {});

}  // namespace nonio::model
