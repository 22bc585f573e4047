// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

/// Effects that a user writes as an expression: [[model.formula]] of the manifest. Every name is a
/// quantity with its unit: `p` and `theta` (position from the middle of the measured range, and as
/// commanded), `t` (time), `K` (temperature difference), `d` (direction, +1 or -1), `run`, the
/// `length`, `duration` and number of `runs` of the measurement, `pitch` and `teeth` of the axis,
/// `air` (K), `pressure` (hPa) and `humidity` (%) as differences from their means, the parameters,
/// and the units (mm, um, m, s, h, kelvin, deg, arcsec, rad). The result is a deviation. A formula
/// whose value depends on the units of the computation is refused.
namespace nonio::config {

/// Returns the effect of a formula. Parameters without a range must enter linearly and become
/// columns; those with a range become shapes, for which `start` and at most `most` other values are
/// tried. A formula without an axis applies to every axis of the kind of `axis`. `tried`: the
/// formula passed the trial on sample readings (finite, linear, unit of a deviation) before. Errors
/// contain the line of the formula.
Expected<Effect> formula_effect(const Formula& formula, const Axis& axis, bool tried = false,
                                int most = 128);

}  // namespace nonio::config
