// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::modelling {

/// Adds an effect to [model] effects of a campaign.toml, or removes it. All other bytes stay the
/// same. An error if the content differs in anything else.
Expected<std::string> with_effect(std::string_view manifest, const std::string& effect);
Expected<std::string> without_effect(std::string_view manifest, const std::string& effect);

/// Adds `lines` to `exclude` of a measurement, and `why` to the reason.
Expected<std::string> with_excluded(std::string_view manifest, const std::string& measurement,
                                    const std::vector<std::uint32_t>& lines,
                                    const std::string& why);
/// Sets `screw_pitch_mm` of an axis. An error if the file does not describe the axis.
Expected<std::string> with_period(std::string_view manifest, const std::string& axis, double mm);

}  // namespace nonio::modelling
