// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The lowest floor of the readers of text: text to fields, fields to numbers, text to words for a
/// user.
namespace nonio::reading {

enum class DecimalMark : std::uint8_t { none, point, comma };

struct Field {
  enum class Kind : std::uint8_t {
    taken,      ///< a finite number below 1e19 in size
    not_taken,  ///< blank, nan, n/a, #N/A (#N/D, #NV), infinite, or 1e19 and more in size
    bad,        ///< anything else
  };
  Kind kind = Kind::bad;
  DecimalMark mark = DecimalMark::none;
  double value = 0.0;
};

/// A decimal number as it stands in a file: sign, digits, one decimal mark, exponent; no thousands
/// separator, no hexadecimal, nothing behind it. The value is the double nearest to the text.
Field parse_number(std::string_view text, bool comma_allowed);

/// What a spreadsheet writes for a value that is not there: #N/A, in other languages #N/D, #NV.
bool missing_in_spreadsheet(std::string_view text);

/// 1..4294967295, digits only; 0 if it is anything else.
std::uint32_t parse_run(std::string_view text);

inline std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Splits a line; fields come trimmed and without the quotes around them. False if a quote is not
/// closed on this line or something stands behind a closing one.
bool split(std::string_view line, char separator, std::vector<std::string_view>& fields);

bool is_utf8(std::string_view text);

/// Text of a file, quoted for a message: shortened, and control characters and bytes that are not
/// UTF-8 as \xHH.
std::string shown(std::string_view text);

/// The name of `names` nearest to `name` by edit distance; names must not be empty.
std::string_view nearest(std::string_view name, const std::vector<std::string_view>& names);

}  // namespace nonio::reading
