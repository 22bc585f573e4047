// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::storage {

/// Returns ` (nearest: "name")` for the candidate with the fewest differences from `found`; "" if
/// no candidate is similar enough.
std::string suggestion(std::string_view found, const std::vector<std::string>& candidates);

/// Returns the names separated by commas ("a, b, c"), without a word of any language.
std::string listed(const std::vector<std::string>& names);

/// Returns the message for a value that is not one of the choices: "expected one of a, b; found
/// "c"", and the nearest choice. If `list` is not empty, it replaces the names of the choices.
std::string not_one_of(const std::vector<std::string>& choices, std::string_view found,
                       std::string list = {});

}  // namespace nonio::storage
