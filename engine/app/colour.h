// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::app {

enum class Colour { red, yellow, green, bold };

/// Returns the text in this color if the file descriptor (STDOUT_FILENO, STDERR_FILENO) is a
/// terminal with colors and NO_COLOR (no-color.org) is not set; otherwise unchanged. Not to be used
/// for JSON or files.
std::string coloured(const std::string& text, Colour colour, int descriptor);

/// Returns the color of a campaign's status or of a decision.
Colour status_colour(const std::string& status);
/// Returns the status (ok, attention, failed) in its color, padded to at least 9 characters.
std::string status_word(const std::string& status, int descriptor);

}  // namespace nonio::app
