// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::controllers {

/// The lines have no line ends (LF or CR LF).
std::vector<std::string_view> lines_of(std::string_view text);
/// An error if the last line has no end, because the file may then be truncated within a number.
Expected<void> ends_whole(std::string_view name, std::string_view text);
/// An error in a file that was recognized as one of this control. Its line number prevents the
/// message "no known control".
tl::unexpected<Error> fail_at(std::string_view name, std::size_t line, const std::string& message);
std::vector<std::string_view> words_of(std::string_view line,
                                       std::string_view separators = " \t\r");
std::string_view trimmed(std::string_view text);
/// Replaces the lines selected by `is_own`, in order, by `lines`, at the place of the first one.
/// Without such lines, inserts `lines` before byte `otherwise`, or returns nullopt. The new lines
/// get the line ends of the text.
std::optional<std::string> with_lines(const std::string& text,
                                      const std::function<bool(std::string_view)>& is_own,
                                      const std::string& lines,
                                      std::optional<std::size_t> otherwise);
/// Removes the comments that Nonio wrote about a table of this axis, because they describe the
/// replaced table. A comment line begins with `mark`; `follows` is called with the line after the
/// comments.
std::string without_origin(const std::string& text, std::string_view mark, std::string_view axis,
                           const std::function<bool(std::string_view)>& follows);
/// Parse the whole text as a finite number or as an integer, with or without a sign.
std::optional<double> real(std::string_view text);
std::optional<std::int64_t> whole(std::string_view text);

/// Parses "0" or "100-227" to first and last; malformed texts are ignored.
std::vector<std::pair<std::int64_t, std::int64_t>> ranges_of(const std::vector<std::string>& texts);

/// Converts to printable ASCII on one line.
std::string plain(std::string_view text);
std::string file_part(std::string_view text);
/// Formats with fixed decimals, and removes trailing zeros, but keeps one decimal.
std::string decimal(double value, int decimals);
/// Formats with fixed decimals and always a sign.
std::string signed_decimal(double value, int decimals);
/// `mark`, such as "; ", precedes each line.
std::string comments(const std::vector<std::string>& lines, std::string_view mark);
std::string joined(const std::vector<std::string>& words, std::string_view between);

}  // namespace nonio::controllers
