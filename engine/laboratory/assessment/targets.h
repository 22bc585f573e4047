// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"
#include "laboratory/statistics/stretch.h"

/// Compares campaigns with different targets. ISO 230-2 requires random offsets of the targets, so
/// their ends differ from campaign to campaign.
namespace nonio::assessment {

/// A fit to values at the targets of a campaign, in the units of the store.
struct StoredFit {
  double beyond = 0.0, dof = 0.0;          ///< variance about the fit in excess of that of the
                                           ///< readings, and degrees of freedom of the fit
  nonio::statistics::FittedCurve curve{};  ///< fitted curve; without coefficients if its quantities
                                           ///< do not refer to the ends of the targets
  /// Coefficients of cosine and sine of each sinusoid in addition to the curve.
  std::vector<nonio::statistics::CoefficientOver> sinusoids{};
  std::vector<double> residuals{};  ///< residual at each target; empty: not stored
};

/// Data of one measurement in the store (results.json, `other_targets`).
struct StoredTargets {
  std::string digest;  ///< digest of the targets; equal for equal targets
  nonio::statistics::Stretch span{};
  std::vector<double> other_variance, share;  ///< one value for each quantity, with the meaning of
                                              ///< the members of `PointTargets`
  StoredFit mean{}, reversal{};
};

/// Parses the texts of the store; none for each text that cannot be read.
std::vector<std::optional<StoredTargets>> read_targets(const std::vector<std::string>& texts);

struct PointTargets {
  std::string digest;
  nonio::statistics::Stretch span{};
  double other_variance = 0.0;  ///< variance that does not come from the readings
  double share = 0.0;           ///< variance for independent values of variance 1 at the targets
  StoredFit fit{};
};

/// Selects the data of a quantity: the fit of the reversal for B_mean, otherwise of the means.
/// `place`: index of the quantity in the measurement.
PointTargets targets_of(const StoredTargets&, const std::string& quantity, std::size_t place);

/// Points compared over a common stretch of the axis. If all points have the same targets, if the
/// targets of a point are unknown, or if the points have no stretch in common, the points are
/// unchanged and `over` is none.
struct Compared {
  std::vector<nonio::statistics::Point> points;
  std::optional<nonio::statistics::Stretch> over{};
};

/// Computes the points of one quantity for comparison. scale, curve_2, curve_3 and B_mean are
/// recomputed from the fitted curves over the stretch that all points have in common; other
/// quantities do not refer to the ends of the targets. Errors between the targets affect each
/// choice of targets differently; their variance, estimated from the variances about the fits of
/// all points, is added as a part that points with these targets have in common. `targets`: one per
/// point, or empty.
Compared compared(std::vector<nonio::statistics::Point> points,
                  const std::vector<PointTargets>& targets, const std::string& quantity);

/// Whether the source of a common uncertainty is a choice of targets (`compared`).
bool is_targets(const std::string& source);

}  // namespace nonio::assessment
