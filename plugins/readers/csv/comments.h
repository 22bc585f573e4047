// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "header.h"
#include "nonio/sdk/plugin.h"

namespace nonio::csv {

/// The first and the last lines of a file, copied: its pages are given back while rows are read.
struct Ends {
  std::string head, foot;
};
Ends ends_of(std::string_view bytes);

/// What comments at the head and the foot of a file state against its columns (a unit) or against
/// the manifest (an axis): `plausibility.comment-unit`, `plausibility.name-of-another`. Only plain
/// statements count ("deviations in nm", "Einheit: inch", "target [m]", "axis: Y"): anything else
/// may be about something else. `last_line`: number of the file's last line.
void doubt_comments(const ReadInput& input, const Ends& ends, std::uint64_t last_line,
                    const Header& header, const Expectation& expectation, Observations& obs);

}  // namespace nonio::csv
