// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Text, names and times in the forms that a PDF has for them.
namespace nonio::pdf {

/// Seconds since 1970-01-01 UTC.
using Time = std::int64_t;

/// A time taken apart, UTC.
struct Calendar {
  int year;
  unsigned month, day;
  int hours, minutes, seconds;
};
Calendar calendar(Time time);

/// "(D:20261121150007Z)".
std::string date_text(Time time);
/// The same as a time; an error for any other form.
Expected<Time> time_in(std::string_view text);

/// UTF-16 with a byte-order mark, from UTF-8; an error if it is none.
Expected<std::string> utf16(std::string_view text);
/// UTF-16 with a byte-order mark as UTF-8; an error for anything else, and for control characters.
Expected<std::string> utf8(std::string_view text);

/// A string as "<0af3>": lower-case hexadecimal.
std::string hexadecimal(std::string_view bytes);
/// "12 0 R".
std::string reference(std::size_t number);
/// The name of an attachment in letters that every reader shows; others become "_".
std::string plain_name(std::string_view name);
/// Text out of an untrusted file, in a message: in quotes, at most 200 bytes of it.
std::string quoted(std::string_view text);

}  // namespace nonio::pdf
