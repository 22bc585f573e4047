// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
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

}  // namespace nonio::app
