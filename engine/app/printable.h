// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::app {

/// Returns text from other sources as one line that is safe on a terminal: control characters,
/// marks that change the direction of writing, invisible characters and invalid UTF-8 become
/// escapes such as \x1b or \u202e.
std::string printable(std::string_view text);

}  // namespace nonio::app
