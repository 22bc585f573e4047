// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "header.h"
#include "nonio/sdk/plugin.h"

namespace nonio::csv {

/// Copies of the first and last lines of a file, whose memory is released during reading.
struct Ends {
  std::string head, foot;
};
Ends ends_of(std::string_view bytes);

/// Adds findings if comments at the beginning or end contradict the columns (unit) or the manifest
/// (axis): `plausibility.comment-unit`, `plausibility.name-of-another`. Only unambiguous statements
/// are used ("deviations in nm", "Einheit: inch", "target [m]", "axis: Y"). `last_line`: number of
/// the last line.
void doubt_comments(const ReadInput& input, const Ends& ends, std::uint64_t last_line,
                    const Header& header, const Expectation& expectation, Observations& obs);

}  // namespace nonio::csv
