// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"

namespace nonio::host {

/// Beside campaign.toml: a JSON object a line for each change of the model, oldest first. It holds
/// no time, so that the same changes leave the same bytes.
inline constexpr const char* history_name = "model-history.jsonl";

std::string history_line(const ModelStep& step);
/// Errors carry the line.
Expected<std::vector<ModelStep>> parse_history(std::string_view text);

}  // namespace nonio::host
