// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::storage {

/// ` (nearest: "name")` for the candidate that differs least from what was found, or "" if none is
/// near enough to be what was meant.
std::string suggestion(std::string_view found, const std::vector<std::string>& candidates);

/// "a, b and c" in no language: "a, b, c".
std::string listed(const std::vector<std::string>& names);

}  // namespace nonio::storage
