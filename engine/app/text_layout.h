// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace nonio::app {

/// Columns that UTF-8 text takes on a terminal: its characters, not its bytes.
std::size_t columns_of(const std::string& text);
/// The text followed by spaces, or after them, up to `width` columns.
std::string padded(const std::string& text, std::size_t width);
std::string padded_left(const std::string& text, std::size_t width);

/// Columns of the terminal of a file descriptor, at least 60 and at most 100; 100 where it is
/// not a terminal.
std::size_t line_width(int descriptor);
/// The same for sentences, which have no limit where it is not a terminal: other programs find each
/// on one line.
std::size_t sentence_width(int descriptor);

/// The lines of `text`, each broken at spaces so that none is wider than `width` and indented by
/// `indent` spaces. What is broken goes on `hanging` spaces further right. A line that begins with
/// a space is kept as it is. Ends with a line feed.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width,
                    std::size_t hanging = 0);

/// One text per row of a table, with a line feed: columns as wide as their content, ranged right, two
/// blanks apart. Where that is wider than `width`, the last columns go on further lines below their
/// row, after the width of the first column. All rows have as many cells as the first.
std::vector<std::string> table_rows(const std::vector<std::vector<std::string>>& rows,
                                    std::size_t width);

}  // namespace nonio::app
