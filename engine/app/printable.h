// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::app {

/// Makes text from other sources safe for a terminal: control characters, direction marks,
/// invisible characters and invalid UTF-8 become escapes such as \x1b or \u202e.
std::string printable(std::string_view text);

}  // namespace nonio::app
