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
/// Every name in an expression is a quantity with its unit: p, theta (position from the middle of
/// the stretch, and as commanded), t (time), K (temperature difference), d (+1, -1), run, the
/// `length`, `duration` and `runs` of what was measured, `pitch` and `teeth` of the axis, `air` (K),
/// `pressure` (hPa) and `humidity` (%) as differences from their means, the
/// parameters, and the units themselves (mm, um, m, s, h, kelvin, deg, arcsec, rad), so that a
/// fixed period is written 10*mm. The result is a deviation. A formula whose value depends on the
/// units in which it is computed is refused: that is the check of its units.
namespace nonio::config {

/// Parameters without a range must enter linearly and become columns; those with one are shapes,
/// searched over it. Errors carry the formula's line. A formula without an axis is of every axis of
/// the kind of `axis`. `tried`: it passed before, and its units are not checked again. `most`: so many values of a range
/// are looked at, fewer of each where there are several.
Expected<Effect> formula_effect(const Formula& formula, const Axis& axis, bool tried = false,
                                int most = 128);

}  // namespace nonio::config
