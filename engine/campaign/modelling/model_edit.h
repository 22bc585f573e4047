// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::modelling {

/// The text of a campaign.toml with one effect more, or less, in the list `effects` of [model].
/// Every other byte stays: comments, order, line ends. The result is parsed again; what would not
/// be exactly the change that was meant is refused.
Expected<std::string> with_effect(std::string_view manifest, const std::string& effect);
Expected<std::string> without_effect(std::string_view manifest, const std::string& effect);

/// The same of other keys. Lines that `exclude` of the measurement has already are not repeated; a
/// reason that is there stays, a new one comes behind it.
Expected<std::string> with_excluded(std::string_view manifest, const std::string& measurement,
                                    const std::vector<std::uint32_t>& lines,
                                    const std::string& why);
/// `screw_pitch_mm` of an axis that campaign.toml describes.
Expected<std::string> with_period(std::string_view manifest, const std::string& axis, double mm);

}  // namespace nonio::modelling
