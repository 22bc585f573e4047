// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::host::modelling {

/// The text of a campaign.toml with one effect more, or less, in the list `effects` of [model].
/// Every other byte stays: comments, order, line ends. The result is parsed again; what would not
/// be exactly the change that was meant is refused.
Expected<std::string> with_effect(std::string_view manifest, const std::string& effect);
Expected<std::string> without_effect(std::string_view manifest, const std::string& effect);

}  // namespace nonio::host::modelling
