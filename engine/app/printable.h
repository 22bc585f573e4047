// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::app {

/// Text from elsewhere as one line that a terminal shows and does not obey: control characters,
/// marks that turn the direction of writing, invisible ones and what is no UTF-8 become \x1b or
/// \u202e.
std::string printable(std::string_view text);

}  // namespace nonio::app
