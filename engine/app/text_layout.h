// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

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

}  // namespace nonio::app
