// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::storage {

/// Returns ` (nearest: "name")` for the candidate with the fewest differences from `found`; "" if
/// no candidate is similar enough.
std::string suggestion(std::string_view found, const std::vector<std::string>& candidates);

std::string listed(const std::vector<std::string>& names);

/// Returns "expected one of a, b; found "c"" with the nearest choice. If `list` is not empty, it
/// replaces the names of the choices.
std::string not_one_of(const std::vector<std::string>& choices, std::string_view found,
                       std::string list = {});

}  // namespace nonio::storage
