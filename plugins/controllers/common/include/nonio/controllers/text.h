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

/// Texts of tables, to be written and to be read.
namespace nonio::controllers {

/// Without the ends of lines, LF or CR LF.
std::vector<std::string_view> lines_of(std::string_view text);
/// An error where the last line has no end: the file was cut, and what is left of a number is
/// another one.
Expected<void> ends_whole(std::string_view name, std::string_view text);
/// An error in a file whose form is that of the control: by its line the file is recognised, and
/// the message is shown in place of "no known control".
tl::unexpected<Error> fail_at(std::string_view name, std::size_t line, const std::string& message);
/// The text between these characters.
std::vector<std::string_view> words_of(std::string_view line,
                                       std::string_view separators = " \t\r");
std::string_view trimmed(std::string_view text);
/// The text with these lines in place of its own ones, where the first of them was; where it has
/// none, in front of byte `otherwise`, or nothing if that is not stated. `is_own` sees the lines
/// one after the other, without their ends; the new ones get the ends that the text has.
std::optional<std::string> with_lines(const std::string& text,
                                      const std::function<bool(std::string_view)>& is_own,
                                      const std::string& lines,
                                      std::optional<std::size_t> otherwise);
/// The text without the comments that Nonio wrote of a table of this axis: they describe the one that
/// is replaced. Comments of others above them stay. A line of comment begins with `mark`; `follows`
/// sees the line after the comments.
std::string without_origin(const std::string& text, std::string_view mark, std::string_view axis,
                           const std::function<bool(std::string_view)>& follows);
/// The whole text as a finite number, with or without its sign.
std::optional<double> real(std::string_view text);
std::optional<std::int64_t> whole(std::string_view text);

/// Numbers and ranges of them, "0", "100-227", as first and last; what is none is left out.
std::vector<std::pair<std::int64_t, std::int64_t>> ranges_of(const std::vector<std::string>& texts);

/// Printable ASCII on one line, whatever the manifest states.
std::string plain(std::string_view text);
/// For file names.
std::string file_part(std::string_view text);
/// Fixed decimals, zeros at the end left out down to one.
std::string decimal(double value, int decimals);
/// Fixed decimals with a sign in any case.
std::string signed_decimal(double value, int decimals);
/// Each line behind this mark: "; ".
std::string comments(const std::vector<std::string>& lines, std::string_view mark);
std::string joined(const std::vector<std::string>& words, std::string_view between);

}  // namespace nonio::controllers
