// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::live {

/// Returns the unified difference of two texts as one hunk; empty if they are equal.
std::string unified_difference(const std::string& name, std::string_view before,
                               std::string_view after);

}  // namespace nonio::live
