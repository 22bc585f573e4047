// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/model/measurements.h"

/// A model compared with the measurements: how well it fits, and where it does not.
namespace nonio::model {

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
  bool together = false;  ///< of two factors: including the effect of each alone
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
  /// Where something fails: the fewest places that hold what is left, each in addition to those before it,
  /// so that nothing is counted twice; no share below 2 %.
  std::vector<Place> seats{};
  std::size_t means = 0;  ///< long tables: number of means that the places are from; else 0
  std::vector<Suspect> suspects{};
  bool fails() const;  ///< something is left in some place
};

/// A place is regarded as failing below this p.
/// docs/dev/constants.md, M1.
inline constexpr double place_p = 0.01;

/// Properties of the readings without any model: how they repeat each other, which are
/// misread, how their noise is correlated. Kept where many models are compared with the same
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

/// Errors are those of `fit`: parameters that the readings do not separate. `known`: of this part,
/// if it exists already.
Expected<Comparison> compare(const Part& part, const std::vector<Term>& model,
                             const Groundwork* known = nullptr, const Fitted& fitted = {});

}  // namespace nonio::model
