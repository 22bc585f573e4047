// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

/// Effects that a user writes as an expression: [[model.formula]] of the manifest.
///
/// Every name in an expression is a quantity with its unit: `p` and `theta` (position from the
/// middle of the measured range, and as commanded), `t` (time), `K` (temperature difference), `d`
/// (direction, +1 or -1), `run`, the `length`, `duration` and number of `runs` of the measurement,
/// `pitch` and `teeth` of the axis, `air` (K), `pressure` (hPa) and `humidity` (%) as differences
/// from their means, the parameters, and the units (mm, um, m, s, h, kelvin, deg, arcsec, rad), so
/// that a fixed period is written 10*mm. The result is a deviation. A formula whose value depends
/// on the units in which it is computed is refused: that is the check of its units.
namespace nonio::config {

/// Returns the effect of a formula. Parameters without a range must enter linearly and become
/// columns; those with a range become shapes, which are searched. A formula without an axis applies
/// to every axis of the kind of `axis`. If `tried`, the formula passed the trial on sample readings
/// (finite, linear, unit of a deviation) before, and the trial is not repeated. In a range, `start`
/// and at most `most` other values are tried, and fewer if several parameters have ranges. Errors
/// contain the line of the formula.
Expected<Effect> formula_effect(const Formula& formula, const Axis& axis, bool tried = false,
                                int most = 128);

}  // namespace nonio::config
