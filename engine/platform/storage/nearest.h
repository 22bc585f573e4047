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

/// What to state of a value that is none of the choices: "expected one of a, b; found "c"", with
/// the nearest. `list`: the choices with what they mean; empty: their names.
std::string not_one_of(const std::vector<std::string>& choices, std::string_view found,
                       std::string list = {});

}  // namespace nonio::storage
