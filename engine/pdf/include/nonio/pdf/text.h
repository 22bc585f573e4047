// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Converts text, names and times to the forms that a PDF uses, and back.
namespace nonio::pdf {

/// A point in time, in seconds since 1970-01-01 00:00 UTC.
using Time = std::int64_t;

/// Date and time of day, UTC.
struct Calendar {
  int year;
  unsigned month, day;
  int hours, minutes, seconds;
};
Calendar calendar(Time time);

/// Returns the time as a PDF states it: "(D:20261121150007Z)".
std::string date_text(Time time);
/// Returns the time that a text in the form of `date_text` states. Error: the text has another
/// form, or this time does not exist.
Expected<Time> time_in(std::string_view text);

/// Converts UTF-8 to UTF-16 with a byte-order mark. Error: the text is not UTF-8.
Expected<std::string> utf16(std::string_view text);
/// Converts UTF-16 with a byte-order mark to UTF-8. Error: the text is not UTF-16 with this mark,
/// or it contains control characters.
Expected<std::string> utf8(std::string_view text);

/// Returns the bytes as a PDF string in lower-case hexadecimal digits: "<0af3>".
std::string hexadecimal(std::string_view bytes);
/// Returns a reference to the object with this number: "12 0 R".
std::string reference(std::size_t number);
/// Returns the name of an attachment in characters that every PDF reader shows: letters, digits,
/// space and - _ . /. Every other byte is replaced by "_".
std::string plain_name(std::string_view name);
/// Returns text from an untrusted file for a message: in quotes, and cut off after 200 bytes.
std::string quoted(std::string_view text);

}  // namespace nonio::pdf
