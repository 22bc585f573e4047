// SPDX-License-Identifier: Apache-2.0
#include "lines.h"

#include <algorithm>
#include <string>

#include "nonio/sdk/fields.h"

namespace nonio::readers {

Lines::Lines(std::string_view bytes)
    : bytes_(bytes), offset_(bytes.size() - without_mark(bytes).size()) {}

bool Lines::next(std::string_view& line) {
  if (offset_ >= bytes_.size()) return false;
  const std::size_t end = std::min(bytes_.find('\n', offset_), bytes_.size());
  line = bytes_.substr(offset_, end - offset_);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  offset_ = end + 1;
  ++number_;
  return true;
}

std::size_t Lines::offset() const { return std::min(offset_, bytes_.size()); }

namespace {

/// #N/A of a spreadsheet is not a comment.
bool begins_with_missing(std::string_view line) {
  const std::size_t end = line.find_first_of(",;\t");
  return end != std::string_view::npos && missing_in_spreadsheet(line.substr(0, end));
}

}  // namespace

Content content_of(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return Content::nothing;
  return line[first] == '#' && !begins_with_missing(line.substr(first)) ? Content::comment
                                                                        : Content::fields;
}

std::optional<Error> not_text(std::string_view line, bool comment) {
  if (line.size() > longest_line)
    return Error{"expected lines of at most " + std::to_string(longest_line) + " bytes, found " +
                 std::to_string(line.size())};
  if (line.find('\0') != line.npos)
    return Error{"expected text in UTF-8, found a NUL byte; is the file UTF-16 or binary?"};
  if (!comment && !is_utf8(line))
    return Error{"expected text in UTF-8, found other bytes; save the file as UTF-8"};
  if (line.find('\r') != line.npos)
    return Error{"expected lines that end in LF or CRLF, found a lone CR"};
  return std::nullopt;
}

std::optional<char> stated_separator(std::string_view line) {
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"')
    line = line.substr(1, line.size() - 2);
  if (line.size() != 5 || !(line.starts_with("sep=") || line.starts_with("SEP=")))
    return std::nullopt;
  return line.back();
}

std::optional<char> Lines::separator() const {
  const std::string_view text = without_mark(bytes_);
  std::string_view line = text.substr(0, text.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return stated_separator(line);
}

std::optional<Error> other_separator(std::optional<char> stated, char found) {
  if (!stated || *stated == found) return std::nullopt;
  const auto name = [](char c) { return c == '\t' ? "a tab" : shown(std::string_view(&c, 1)); };
  return Error{"expected " + name(*stated) +
               " between the names of the columns, as \"sep=\" in line 1 states, found " +
               name(found)};
}

bool next_content(Lines& lines, std::string_view& line, std::optional<Error>& error) {
  while (lines.next(line)) {
    const Content content = content_of(line);
    if (content == Content::nothing) continue;
    if (lines.number() == 1 && stated_separator(line)) continue;
    if (content == Content::fields) return true;
    error = not_text(line, true);
    if (error) return false;
  }
  return false;
}

}  // namespace nonio::readers
