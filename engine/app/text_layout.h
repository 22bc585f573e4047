// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nonio::app {

/// Returns the number of characters of UTF-8 text; each is assumed to occupy one column.
std::size_t columns_of(const std::string& text);
/// Fill the text with spaces to `width` columns, after the text or (padded_left) before it.
std::string padded(const std::string& text, std::size_t width);
std::string padded_left(const std::string& text, std::size_t width);

/// Returns the width of the terminal in columns, from 60 to 100; 100 without a terminal.
std::size_t line_width(int descriptor);
/// Returns `line_width`, or no limit without a terminal, so that other programs get each sentence
/// on one line.
std::size_t sentence_width(int descriptor);

/// Breaks `text` at spaces into lines of at most `width` columns, indented by `indent` spaces;
/// continuation lines by `hanging` more. A line that begins with a space is not broken. The result
/// ends with a line feed.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width,
                    std::size_t hanging = 0);

/// Returns one text per row with right-aligned columns, two spaces apart. If a row is wider than
/// `width`, its last columns continue on further lines. All rows must have the same number of
/// cells.
std::vector<std::string> table_rows(const std::vector<std::vector<std::string>>& rows,
                                    std::size_t width);

/// Makes text from other sources safe for a terminal: control characters, direction marks,
/// invisible characters and invalid UTF-8 become escapes such as \x1b or \u202e.
std::string printable(std::string_view text);

enum class Colour { red, yellow, green, bold };

/// Adds the escape sequences of a color if the file descriptor is a terminal with colors and
/// NO_COLOR (no-color.org) is not set. Not for JSON or files.
std::string coloured(const std::string& text, Colour colour, int descriptor);

/// Returns the color of a campaign status (ok, attention, failed) or of a conformity decision.
Colour status_colour(const std::string& status);
/// Returns the status in its color, padded to at least 9 characters.
std::string status_word(const std::string& status, int descriptor);

}  // namespace nonio::app
