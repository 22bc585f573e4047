// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "header.h"
#include "nonio/sdk/plugin.h"

namespace nonio::csv {

/// What comments at the head and the foot of a file say against its columns (a unit) or against the
/// manifest (an axis): `plausibility.comment-unit`, `plausibility.name-of-another`. Only plain
/// statements count ("deviations in nm", "Einheit: inch", "target [m]", "axis: Y"): anything else
/// may be about something else.
void doubt_comments(const ReadInput& input, const Header& header, const Expectation& expectation,
                    Observations& obs);

}  // namespace nonio::csv
