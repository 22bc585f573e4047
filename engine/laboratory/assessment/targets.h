// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"
#include "laboratory/statistics/stretch.h"

/// Comparison of campaigns that have other targets. ISO 230-2 requires random offsets of the
/// targets, so their ends differ from campaign to campaign.
namespace nonio::assessment {

/// A fit to values at the targets of a campaign; units of the store.
struct StoredFit {
  double beyond = 0.0, dof = 0.0;          ///< variance about the fit beyond the readings
  nonio::statistics::FittedCurve curve{};  ///< no coefficients: its quantities do not refer to ends
  /// Of cos and sin of each sinusoid in addition to it.
  std::vector<nonio::statistics::CoefficientOver> sinusoids{};
  std::vector<double> residuals{};  ///< of the values, by target; none: not in the store
};

/// What the store has of one measurement (results.json, `other_targets`).
struct StoredTargets {
  std::string digest;  ///< the same: the same targets
  nonio::statistics::Stretch span{};
  std::vector<double> other_variance, share;  ///< of each quantity
  StoredFit mean{}, reversal{};
};

/// Of texts of the store, each; none that cannot be read.
std::vector<std::optional<StoredTargets>> read_targets(const std::vector<std::string>& texts);

/// Of one point.
struct PointTargets {
  std::string digest;
  nonio::statistics::Stretch span{};
  double other_variance = 0.0;  ///< variance that does not come from the readings
  double share = 0.0;
  StoredFit fit{};
};

/// The parts that this quantity needs.
PointTargets targets_of(const StoredTargets&, const std::string& quantity, std::size_t place);

/// Points that are compared over a stretch of the axis. Where all have the same targets they are
/// what they are, and there is no stretch.
struct Compared {
  std::vector<nonio::statistics::Point> points;
  std::optional<nonio::statistics::Stretch> over{};
};

/// scale, curve_2, curve_3 and B_mean are those of the fitted curves over the stretch that all
/// points have in common; other quantities do not refer to the ends of the targets. What a machine
/// has between its targets is seen by each choice of targets differently: a common part of the
/// points with these targets, from the variances about the fits of all points.
/// targets: of each point, or none.
Compared compared(std::vector<nonio::statistics::Point> points,
                  const std::vector<PointTargets>& targets, const std::string& quantity);

/// Whether a source of a common part is a choice of targets.
bool is_targets(const std::string& source);

}  // namespace nonio::assessment
