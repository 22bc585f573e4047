// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace nonio::app {

/// Returns the columns that UTF-8 text occupies on a terminal: its number of characters.
std::size_t columns_of(const std::string& text);
/// Returns the text filled up with spaces to `width` columns, on the right or (padded_left) on the
/// left.
std::string padded(const std::string& text, std::size_t width);
std::string padded_left(const std::string& text, std::size_t width);

/// Returns the columns of the terminal of a file descriptor, at least 60 and at most 100; 100 if it
/// is not a terminal.
std::size_t line_width(int descriptor);
/// Returns the same width as `line_width` for sentences. It is unlimited if the descriptor is not a
/// terminal, so that other programs get each sentence on one line.
std::size_t sentence_width(int descriptor);

/// Returns the lines of `text`, broken at spaces to at most `width` columns and indented by
/// `indent` spaces. Continuation lines are indented by `hanging` more spaces. A line that begins
/// with a space is indented and not broken. The result ends with a line feed.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width,
                    std::size_t hanging = 0);

/// Returns one text per row of a table, with a line feed: columns as wide as their content,
/// right-aligned, separated by two blanks. If this is wider than `width`, the last columns continue
/// on further lines below their row, indented by the width of the first column. All rows must have
/// as many cells as the first.
std::vector<std::string> table_rows(const std::vector<std::vector<std::string>>& rows,
                                    std::size_t width);

}  // namespace nonio::app
