// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::app {

enum class Colour { red, yellow, green, bold };

/// The text in that colour if the file descriptor (STDOUT_FILENO,
/// STDERR_FILENO) is a terminal that can show it and NO_COLOR (no-color.org) is
/// not set; else as it is. Never for JSON or files.
std::string coloured(const std::string& text, Colour colour, int descriptor);

/// Of a campaign's status or a decision.
Colour status_colour(const std::string& status);
/// ok, attention or failed as a column of a list, in its colour.
std::string status_word(const std::string& status, int descriptor);

}  // namespace nonio::app
