// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::spreadsheet {

/// An unpacked member of a ZIP archive; nullopt if missing. Errors: an invalid archive, more than
/// `most_members` members, or a member that is encrypted or larger than `most_bytes`.
inline constexpr std::size_t most_members = 10000;
inline constexpr std::size_t most_bytes = std::size_t{256} << 20;
Expected<std::optional<std::string>> member(std::string_view archive, const std::string& name);

}  // namespace nonio::spreadsheet
