// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::modelling {

/// Returns the text of a campaign.toml with an effect added to the list `effects` of [model], or
/// removed from it. All other bytes stay the same: comments, order, line ends. The result is parsed
/// again; an error if it differs from the old content in anything else.
Expected<std::string> with_effect(std::string_view manifest, const std::string& effect);
Expected<std::string> without_effect(std::string_view manifest, const std::string& effect);

/// Returns the text of a campaign.toml with `lines` added to `exclude` of a measurement, except
/// those already in the list, and with `why` added to the reason.
Expected<std::string> with_excluded(std::string_view manifest, const std::string& measurement,
                                    const std::vector<std::uint32_t>& lines,
                                    const std::string& why);
/// Returns the text of a campaign.toml with `screw_pitch_mm` (mm) set for an axis. An error if the
/// file does not describe the axis.
Expected<std::string> with_period(std::string_view manifest, const std::string& axis, double mm);

}  // namespace nonio::modelling
