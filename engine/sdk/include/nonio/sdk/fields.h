// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "nonio/sdk/format.h"
#include "nonio/sdk/powers_of_10.h"
#include "nonio/sdk/text.h"

namespace nonio::readers {

enum class DecimalMark : std::uint8_t { none, point, comma };

struct Field {
  enum class Kind : std::uint8_t {
    taken,  ///< a finite number with an absolute value below 1e19
    /// Blank, nan, n/a, #N/A (#N/D, #NV), "over range" and similar texts, infinite, or an absolute
    /// value of at least 1e19.
    not_taken,
    bad,
  };
  Kind kind = Kind::bad;
  DecimalMark mark = DecimalMark::none;
  double value = 0.0;
};

inline std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

bool missing_in_spreadsheet(std::string_view text);

namespace detail {

/// Numbers of at least this absolute value denote a missing reading.
inline constexpr double sentinel = 1e19;

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline bool same_word(std::string_view text, std::string_view lower) {
  return std::equal(text.begin(), text.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

inline bool means_not_taken(std::string_view text) {
  if (text.empty() || same_word(text, "n/a")) return true;
  if (missing_in_spreadsheet(text)) return true;
  if (text.front() == '+' || text.front() == '-') text.remove_prefix(1);
  for (const std::string_view mark : {"nan", "inf", "infinity", "out of range", "over range",
                                      "overrange", "under range", "underrange"})
    if (same_word(text, mark)) return true;
  return false;
}

/// value = digits * 10^exponent
struct Decimal {
  bool negative = false;
  std::uint64_t digits = 0;  ///< invalid if there are more than 19 digits
  long count = 0;            ///< number of digits, including leading zeros
  long exponent = 0;         ///< power of ten of the last digit
  DecimalMark mark = DecimalMark::none;
};

/// Returns the end of the digits.
inline const char* take_digits(const char* p, const char* end, std::uint64_t& digits) {
  for (; p != end && is_digit(*p); ++p) digits = digits * 10 + static_cast<std::uint64_t>(*p - '0');
  return p;
}

/// Parses an exponent [eE][+-]digits, which must extend to `end`, and adds it to `d.exponent`. An
/// empty text is accepted.
inline bool take_exponent(const char* p, const char* end, Decimal& d) {
  if (p == end) return true;
  if (*p != 'e' && *p != 'E') return false;
  ++p;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  if (p == end) return false;
  long e = 0;
  for (; p != end; ++p) {
    if (!is_digit(*p)) return false;
    e = std::min(e * 10 + (*p - '0'), 1000000L);
  }
  d.exponent += negative ? -e : e;
  return true;
}

inline bool parse_decimal(std::string_view text, bool comma_allowed, Decimal& d) {
  const char* first = text.data();
  const char* const end = first + text.size();
  if (first != end && (*first == '-' || *first == '+')) d.negative = *first++ == '-';
  const char* p = take_digits(first, end, d.digits);
  d.count = p - first;
  if (p != end && (*p == '.' || (comma_allowed && *p == ','))) {
    d.mark = *p == '.' ? DecimalMark::point : DecimalMark::comma;
    first = ++p;
    p = take_digits(first, end, d.digits);
    d.count += p - first;
    d.exponent = first - p;
  }
  return d.count > 0 && take_exponent(p, end, d);
}

/// Converts a well-formed text with the standard library, for numbers whose digits or power of ten
/// a double does not represent exactly. Returns positive infinity if the number is too large for a
/// double, and 0 if it is too small.
inline double slow_value(std::string_view text, const Decimal& d) {
  std::string plain(text.front() == '+' ? text.substr(1) : text);
  std::replace(plain.begin(), plain.end(), ',', '.');
  double value = 0.0;
  const auto [ptr, error] =
      std::from_chars(plain.data(), plain.data() + plain.size(), value, std::chars_format::general);
  if (error == std::errc{}) return value;
  // The position of the first significant digit determines whether the number is too large or too
  // small.
  long zeros = 0;
  for (const char c : plain) {
    if (c >= '1' && c <= '9') break;
    if (c == '0') ++zeros;
  }
  const bool large = d.count - zeros + d.exponent > 0;
  return large ? std::numeric_limits<double>::infinity() : 0.0;
}

}  // namespace detail

/// Whether the text is #N/A, or #N/D or #NV in other languages.
inline bool missing_in_spreadsheet(std::string_view text) {
  return detail::same_word(text, "#n/a") || detail::same_word(text, "#n/d") ||
         detail::same_word(text, "#nv");
}

/// Syntax: sign, digits, one decimal mark, exponent; no thousands separator, no hexadecimal, no
/// further text. The value is the double nearest to the text.
inline Field parse_number(std::string_view text, bool comma_allowed) {
  detail::Decimal d;
  if (!detail::parse_decimal(text, comma_allowed, d)) {
    const auto kind = detail::means_not_taken(text) ? Field::Kind::not_taken : Field::Kind::bad;
    return {kind, DecimalMark::none, 0.0};
  }
  double value = 0.0;
  // Both factors are exact in a double, so the operation rounds only once (W. D. Clinger, How to
  // read floating point numbers accurately, PLDI 1990).
  constexpr std::uint64_t exact = 1ULL << 53U;
  if (d.count <= 19 && d.digits <= exact && d.exponent >= -22 && d.exponent <= 22) {
    value = static_cast<double>(d.digits);
    value = d.exponent < 0 ? value / exact_powers_of_10[static_cast<std::size_t>(-d.exponent)]
                           : value * exact_powers_of_10[static_cast<std::size_t>(d.exponent)];
    if (d.negative) value = -value;
  } else {
    value = detail::slow_value(text, d);
  }
  const auto kind =
      std::fabs(value) < detail::sentinel ? Field::Kind::taken : Field::Kind::not_taken;
  return {kind, d.mark, value + 0.0};  // converts -0.0 to 0.0
}

/// Accepts 1 to 4294967295, digits only; 0 for any other text.
inline std::uint32_t parse_run(std::string_view text) {
  std::uint64_t run = 0;
  if (text.empty()) return 0;
  for (const char c : text) {
    if (!detail::is_digit(c)) return 0;
    run = run * 10 + static_cast<std::uint64_t>(c - '0');
    if (run > std::numeric_limits<std::uint32_t>::max()) return 0;
  }
  return static_cast<std::uint32_t>(run);
}

namespace detail {

/// Extracts the quoted field that begins at `open`; returns the position after it, or npos if it is
/// malformed.
inline std::size_t quoted_end(std::string_view line, std::size_t open, char separator,
                              std::string_view& field) {
  std::size_t close = line.find('"', open + 1);
  while (close != line.npos && close + 1 < line.size() && line[close + 1] == '"')
    close = line.find('"', close + 2);
  if (close == line.npos) return line.npos;
  field = trimmed(line.substr(open + 1, close - open - 1));
  std::size_t end = close + 1;
  while (end < line.size() && line[end] == ' ') ++end;
  return end == line.size() || line[end] == separator ? end : line.npos;
}

}  // namespace detail

/// Splits a line into trimmed fields without the enclosing quotes; doubled quotes remain doubled.
/// False if a quoted field is not terminated on this line, or if text follows a closing quote.
inline bool split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  const char* const end = line.data() + line.size();
  for (const char* p = line.data();; ++p) {
    while (p != end && *p == ' ') ++p;
    if (p != end && *p == '"') {
      std::string_view field;
      const auto after =
          detail::quoted_end(line, static_cast<std::size_t>(p - line.data()), separator, field);
      if (after == line.npos) return false;
      fields.push_back(field);
      p = line.data() + after;
    } else {
      const char* const first = p;
      while (p != end && *p != separator) ++p;
      fields.push_back(trimmed({first, static_cast<std::size_t>(p - first)}));
    }
    if (p == end) return true;
  }
}

/// Quotes text for a message, with at most 40 bytes of it; control characters, and bytes that are
/// not UTF-8, become \xHH.
inline std::string shown(std::string_view text) {
  constexpr std::size_t most = 40;
  constexpr std::string_view hex = "0123456789ABCDEF";
  std::string_view part = text.substr(0, most);
  while (part.size() < text.size() && !part.empty() &&
         (static_cast<unsigned char>(text[part.size()]) & 0xC0U) == 0x80)
    part.remove_suffix(1);
  const bool readable = is_utf8(part);
  std::string out = "\"";
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto byte = static_cast<unsigned char>(part[i]);
    const bool control = byte == 0xC2 && readable && static_cast<unsigned char>(part[i + 1]) < 0xA0;
    if ((byte >= 0x20 && byte < 0x7F) || (byte >= 0x80 && readable && !control)) {
      out += part[i];
      continue;
    }
    const std::size_t last = control ? i + 1 : i;
    for (; i <= last; ++i) {
      out += "\\x";
      out += hex[static_cast<unsigned char>(part[i]) >> 4U];
      out += hex[static_cast<unsigned char>(part[i]) & 15U];
    }
    --i;
  }
  return out + (part.size() < text.size() ? "...\"" : "\"");
}

/// The Levenshtein distance in bytes.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replace = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min(replace, std::min(row[k], diagonal) + 1);
    }
  }
  return row.back();
}

/// Returns the first of the names with the smallest edit distance to the first 24 bytes of `name`.
/// `names` must not be empty.
inline std::string_view nearest(std::string_view name, const std::vector<std::string_view>& names) {
  name = name.substr(0, 24);
  std::string_view best = names.front();
  std::size_t least = edit_distance(name, best);
  for (const std::string_view candidate : names) {
    const std::size_t a = name.size(), b = candidate.size();
    // The distance is at least the difference of the lengths.
    if ((a > b ? a - b : b - a) >= least) continue;
    const std::size_t distance = edit_distance(name, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

}  // namespace nonio::readers

namespace nonio {

/// Formats a field of a CSV file, quoted if RFC 4180 requires it. A leading apostrophe prevents a
/// spreadsheet from interpreting text that starts with = + - @, tab or CR as a formula.
inline std::string csv_text(std::string_view words) {
  std::string field(words);
  if (!field.empty() && std::string_view("=+-@\t\r").find(field.front()) != std::string_view::npos)
    field.insert(0, 1, '\'');
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace nonio
