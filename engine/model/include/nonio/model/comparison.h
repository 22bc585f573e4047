// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/measurements.h"

/// Comparison of a model with the measurements: how well it fits, and where it does not.
namespace nonio::model {

/// Standard deviation of repeated readings of one target in one direction: that of the residuals of
/// the fit, after the mean of each target and direction and the terms of a whole pass (zero, slope
/// and curvature) are subtracted. At least digit/sqrt(12), the scatter that a coarse display can
/// hide. For a course it is estimated from the second differences of the residuals.
struct NoiseFloor {
  double s = 0.0;  ///< standard deviation, m or rad
  /// standard uncertainty of s: s / sqrt(2 dof), combined with the contribution of an uncertain
  /// correlation of adjacent readings
  double u = 0.0;
  double dof = 0.0;  ///< degrees of freedom
};

/// F-test of the model against the cell means; absent if the repeats have fewer than 3 degrees of
/// freedom, or if dof1 < 1. e are the weighted residuals of a fit of redundancy dof1 + r, r is the
/// number of degrees of freedom of the repeated readings, s is their standard deviation, and dof2
/// is the number of degrees of freedom of s.
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

/// Returns the name: "direction", "screw-phase", for a product "direction x time".
std::string to_text(const Where& where);

/// A structure that remains in the residuals, by the factor with which it varies.
struct Place {
  Where where;
  /// share of the residual sum of squares; for `Comparison::places` minus the share expected from
  /// noise
  double share = 0.0;
  /// p-value of an F-test, or of a t-test of one target or run if it is smaller; corrected for the
  /// number of places tested
  double p = 1.0;
  double rms = 0.0;  ///< rms of this structure, m or rad
  /// Main position of the structure: a target (m or rad), the number of a run, or an instant (s);
  /// none without a main position.
  std::optional<double> at{};
  Quantity at_quantity = Quantity::number;
  /// in space: name of the line along which the position is counted; for the factor `channel`: name
  /// of the channel
  std::string line{};
  bool together = false;  ///< for two factors: whether `share` includes the effect of each factor
                          ///< alone
};

/// A reading that contradicts other readings; it is kept, with weight 0, until the user excludes
/// it.
struct Suspect {
  std::size_t row = 0;  ///< row in the part's table
  double residual = 0.0;
  double t = 0.0;  ///< studentized residual
  /// smallest error of this reading that would be detected, m or rad
  double minimal_detectable = 0.0;
};

struct Comparison {
  Fit fit;
  /// residual with the largest absolute value, with its sign, m or rad; suspect readings excluded
  double largest = 0.0;
  std::size_t largest_row = 0;
  /// RMS of cross-validation over runs or, for a course, blocks of time, m or rad; absent if no run
  /// could be predicted
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

/// Properties of the readings that do not depend on a model: which readings repeat each other,
/// which are suspect, and the correlation of their noise. They are computed once if many models are
/// compared with the same readings.
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

/// Function that `compare` calls for a long table when the fit is complete, before places are
/// tested.
using Fitted = std::function<void(const Comparison&)>;

/// Fits a model and compares it with the readings. An error if there are no readings, or if `fit`
/// fails, for example because the readings do not separate some parameters. `known`: the groundwork
/// of this part, if it already exists. `fitted`: called for a long table only.
Expected<Comparison> compare(const Part& part, const std::vector<Term>& model,
                             const Groundwork* known = nullptr, const Fitted& fitted = {});

}  // namespace nonio::model
