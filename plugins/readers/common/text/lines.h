// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::readers {

inline constexpr std::size_t longest_line = 65536;

/// Iterates over the lines of a file, without LF or CRLF; a CR at the end of the file is treated as
/// CRLF.
class Lines {
 public:
  explicit Lines(std::string_view bytes);
  bool next(std::string_view& line);
  /// Line number of the last returned line, from 1.
  std::uint64_t number() const { return number_; }
  std::size_t offset() const;
  /// Separator according to a first line "sep=;".
  std::optional<char> separator() const;

 private:
  std::string_view bytes_;
  std::size_t offset_ = 0;
  std::uint64_t number_ = 0;
};

enum class Content { nothing, comment, fields };
Content content_of(std::string_view line);

/// Error: characters that a text file must not contain. Rows of numbers need no such check, because
/// their fields would not be numbers. Comments are not interpreted and may be in any code page.
std::optional<Error> not_text(std::string_view line, bool comment = false);

/// Separator according to Excel's first line "sep=;"; none for any other line.
std::optional<char> stated_separator(std::string_view line);

/// Error: a first line "sep=;" and the header row disagree.
std::optional<Error> other_separator(std::optional<char> stated, char found);

/// Reads the next line with fields, ignoring a first line "sep=;"; false at the end of the file, or
/// if `error` is set.
bool next_content(Lines& lines, std::string_view& line, std::optional<Error>& error);

}  // namespace nonio::readers
