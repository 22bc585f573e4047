// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::pdf {

/// Seconds since 1970-01-01 00:00 UTC.
using Time = std::int64_t;

/// A date and time of day in UTC.
struct Calendar {
  int year;
  unsigned month, day;
  int hours, minutes, seconds;
};
Calendar calendar(Time time);

/// Returns "(D:20261121150007Z)".
std::string date_text(Time time);
/// Inverse of `date_text`. Error: the text has another form, or this time does not exist.
Expected<Time> time_in(std::string_view text);

/// The result has a byte-order mark. Error: the text is not UTF-8.
Expected<std::string> utf16(std::string_view text);
/// Error: the text is not UTF-16 with a byte-order mark, or it contains control characters.
Expected<std::string> utf8(std::string_view text);

/// Returns a PDF string in lower-case hexadecimal digits: "<0af3>".
std::string hexadecimal(std::string_view bytes);
/// Returns "12 0 R".
std::string reference(std::size_t number);
/// Replaces every byte by "_" that is not a letter, digit, space or one of - _ . /, because not
/// every PDF reader shows other characters.
std::string plain_name(std::string_view name);
/// For text from an untrusted file in a message; it is cut off after 200 bytes.
std::string quoted(std::string_view text);

}  // namespace nonio::pdf
