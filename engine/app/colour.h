// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::app {

enum class Colour { red, yellow, green, bold };

/// Adds the escape sequences of a color if the file descriptor is a terminal with colors and
/// NO_COLOR (no-color.org) is not set. Not for JSON or files.
std::string coloured(const std::string& text, Colour colour, int descriptor);

/// Returns the color of a campaign status (ok, attention, failed) or of a conformity decision.
Colour status_colour(const std::string& status);
/// Returns the status in its color, padded to at least 9 characters.
std::string status_word(const std::string& status, int descriptor);

}  // namespace nonio::app
