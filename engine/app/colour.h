// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::app {

enum class Colour { red, yellow, green, bold };

/// Returns the text in that colour if the file descriptor (STDOUT_FILENO, STDERR_FILENO) is a
/// terminal with colours and NO_COLOR (no-color.org) is not set; otherwise unchanged. Not to be
/// used for JSON or files.
std::string coloured(const std::string& text, Colour colour, int descriptor);

/// Returns the colour of a campaign's status or of a decision.
Colour status_colour(const std::string& status);
/// Returns ok, attention or failed in its colour, padded to the width of a column.
std::string status_word(const std::string& status, int descriptor);

}  // namespace nonio::app
