// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

/// A member of a ZIP archive, unpacked; none if it has no such member. Errors: bytes that are no
/// archive, more members than `most_members`, a member that unpacks to more than `most_bytes` or that
/// is encrypted.
inline constexpr std::size_t most_members = 10000;
inline constexpr std::size_t most_bytes = std::size_t{256} << 20;
Expected<std::optional<std::string>> member(std::string_view archive, const std::string& name);

}  // namespace nonio::spreadsheet
