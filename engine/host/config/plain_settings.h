// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "nonio/sdk/settings.h"

namespace nonio::host::config {

/// What `parse_settings` gives for a file of words: comments, headers of tables, and texts in double quotes, each on a
/// line of its own. Takes a twentieth of the instructions of the parser of TOML. Nothing where anything else stands in
/// it, or anything that may be an error: then that parser reads it, and says what is wrong.
std::optional<Settings> plain_settings(std::string_view text);

}  // namespace nonio::host::config
