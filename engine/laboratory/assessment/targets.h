// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"
#include "laboratory/statistics/stretch.h"

/// Compares campaigns whose targets have different ends, because ISO 230-2 requires random offsets
/// of the targets.
namespace nonio::assessment {

/// A fit to the values at the targets of a campaign, in the units of the store.
struct StoredFit {
  /// Excess of the variance about the fit over that of the readings, and degrees of freedom.
  double beyond = 0.0, dof = 0.0;
  /// Has no coefficients if the quantities do not depend on the ends of the targets.
  nonio::statistics::FittedCurve curve{};
  /// Coefficients of cosine and sine of each sinusoid.
  std::vector<nonio::statistics::CoefficientOver> sinusoids{};
  std::vector<double> residuals{};  ///< by target; empty if not stored
};

/// Data of one measurement (`other_targets` in results.json).
struct StoredTargets {
  std::string digest;  ///< equal for equal targets
  nonio::statistics::Stretch span{};
  std::vector<double> other_variance, share;  ///< by quantity; see `PointTargets`
  StoredFit mean{}, reversal{};
};

/// An entry is std::nullopt if its text cannot be parsed.
std::vector<std::optional<StoredTargets>> read_targets(const std::vector<std::string>& texts);

struct PointTargets {
  std::string digest;
  nonio::statistics::Stretch span{};
  double other_variance = 0.0;  ///< variance of other origin than the readings
  /// Variance of the quantity for independent values of variance 1 at the targets.
  double share = 0.0;
  StoredFit fit{};
};

/// Returns the fit of the reversal for B_mean, otherwise that of the means. `place` is the index of
/// the quantity in the measurement.
PointTargets targets_of(const StoredTargets&, const std::string& quantity, std::size_t place);

/// Points compared over a common stretch of the axis. They are unchanged, with `over` std::nullopt,
/// if all targets are equal, if targets are unknown, or without a common stretch.
struct Compared {
  std::vector<nonio::statistics::Point> points;
  std::optional<nonio::statistics::Stretch> over{};
};

/// Computes comparable points of one quantity: scale, curve_2, curve_3 and B_mean are computed
/// again from the fitted curves over the common stretch; sinusoids are taken from the stored fits.
/// The variance of the error between targets, estimated from the fits of all points, is added in
/// two common uncertainties: the part that depends on the choice of targets is common to points
/// with equal targets, the rest to points with equal numbers of targets and degrees of freedom.
/// Points with equal targets throughout are unchanged. `targets` has one entry per point or is
/// empty.
Compared compared(std::vector<nonio::statistics::Point> points,
                  const std::vector<PointTargets>& targets, const std::string& quantity);

/// Whether the common uncertainty is due to the choice of targets.
bool is_targets(const std::string& source);

}  // namespace nonio::assessment
