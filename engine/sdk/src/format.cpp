// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/format.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "nonio/sdk/powers_of_10.h"

// All three methods of rounding are exact. Two are faster but not always applicable: one product if
// no tie is near (`quickly_rounded`), and the same product to 12 digits (`quick_decimal`). The
// third uses the decimal digits of std::to_chars.
namespace nonio {
namespace {

// Returns size * 10^places rounded to an integer. Returns std::nullopt for places outside of 0..22,
// for a product of 10^12 or more, or within 0.01 of a tie, which rounding errors of the product
// could decide.
std::optional<std::int64_t> quickly_rounded(double size, int places) {
  if (places < 0 || places >= static_cast<int>(exact_powers_of_10.size())) return std::nullopt;
  const double product = size * exact_powers_of_10[static_cast<std::size_t>(places)];
  if (!(product < 1e12)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(product);
  const double rest = product - static_cast<double>(whole);
  if (std::fabs(rest - 0.5) < 0.01) return std::nullopt;
  return rest > 0.5 ? whole + 1 : whole;
}

std::optional<Decimal> quick_decimal(double size) {
  if (!(size >= 1e-11 && size < 1e12)) return std::nullopt;
  int places = 11;
  while (size >= exact_powers_of_10[static_cast<std::size_t>(12 - places)]) --places;
  if (places == 11)  // The size is below 10, perhaps even below 1.
    while (size * exact_powers_of_10[static_cast<std::size_t>(places - 11)] < 1.0) ++places;
  const auto digits = quickly_rounded(size, places);
  return digits ? std::optional(Decimal{*digits, places}) : std::nullopt;
}

}  // namespace

double Decimal::value() const {
  return static_cast<double>(digits) / exact_powers_of_10[static_cast<std::size_t>(places)];
}

std::string fixed_text_by_digits(double value, int decimals) {
  constexpr int held = 15;
  std::array<char, 32> buffer{};  // format: d.dddddddddddddde+xx
  const char* const end = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                        std::fabs(value), std::chars_format::scientific, held - 1)
                              .ptr;
  int exponent = 0;
  const char* const from = buffer.data() + held + 2;
  std::from_chars(*from == '+' ? from + 1 : from, end, exponent);
  std::string digits = std::string(1, buffer[0]) + std::string(buffer.data() + 2, held - 1);
  int whole = exponent + 1;
  if (whole < 1) {
    digits.insert(0, static_cast<std::size_t>(1 - whole), '0');
    whole = 1;
  }
  const auto kept = static_cast<std::size_t>(whole) + static_cast<std::size_t>(decimals);
  const bool up = kept < digits.size() && digits[kept] >= '5';
  digits.resize(kept, '0');
  if (up) {
    std::size_t i = kept;
    while (i > 0 && digits[i - 1] == '9') digits[--i] = '0';
    if (i > 0)
      ++digits[i - 1];
    else
      digits.insert(0, 1, '1'), ++whole;
  }
  const bool negative = value < 0.0 && digits.find_first_not_of('0') != std::string::npos;
  if (decimals > 0) digits.insert(static_cast<std::size_t>(whole), 1, '.');
  return negative ? "-" + digits : digits;
}

int place_of_second_digit(double size) {
  const int place = static_cast<int>(std::floor(std::log10(size))) - 1;
  const double carried = std::round(size / std::pow(10.0, place));
  return carried >= 100.0 ? place + 1 : place;
}

std::string rounded_text(double value, int place) {
  if (place <= 0) return fixed_text(value, -place);
  const double unit = std::pow(10.0, place);
  return fixed_text(std::round(value / unit) * unit, 0);
}

double rounded_by_digits(double value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::scientific, 11)
                       .ptr;
  double rounded = value;
  std::from_chars(buffer.data(), end, rounded);
  return rounded == 0.0 ? 0.0 : rounded;
}

std::string decimal_text(std::int64_t digits, int places, bool negative) {
  std::array<char, 64> text{};
  char* const end = text.data() + text.size();
  char* at = end;
  for (int i = 0; i <= places || digits != 0; ++i, digits /= 10) {
    if (i == places && places > 0) *--at = '.';
    *--at = static_cast<char>('0' + digits % 10);
  }
  if (negative && std::any_of(at, end, [](char c) { return c >= '1' && c <= '9'; })) *--at = '-';
  return {at, end};
}

std::string fixed_text(double value, int decimals) {
  if (!std::isfinite(value)) return "";
  if (const auto digits = quickly_rounded(std::fabs(value), decimals))
    return decimal_text(*digits, decimals, value < 0.0);
  return fixed_text_by_digits(value, decimals);
}

std::optional<RoundedResult> rounded_result(double value, double U) {
  if (!(U > 0.0) || !std::isfinite(U) || !std::isfinite(value)) return std::nullopt;
  constexpr int last = -9;
  const int place = std::max(place_of_second_digit(U), last);
  return RoundedResult{rounded_text(value, place), rounded_text(std::max(U, 1e-9), place)};
}

std::string short_text(double value, int significant) {
  if (!std::isfinite(value)) return "";
  const double size = std::fabs(value);
  if (size != 0.0 && (size < 1e-4 || size >= 1e9)) {
    std::array<char, 64> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                   std::chars_format::scientific, std::max(0, significant - 1))
                         .ptr;
    return {buffer.data(), end};
  }
  const int magnitude = size == 0.0 ? 0 : static_cast<int>(std::floor(std::log10(size)));
  return fixed_text(value, std::clamp(significant - 1 - magnitude, 0, 9));
}

double printed(double si, Quantity quantity) {
  const double value = si * unit_of(quantity).per_si;
  if (!std::isfinite(value)) return value;
  if (value == 0.0) return 0.0;
  if (const auto decimal = quick_decimal(std::fabs(value)))
    return std::copysign(decimal->value(), value);
  return rounded_by_digits(value);
}

std::optional<Decimal> shortest_decimal(double size) {
  auto decimal = quick_decimal(size);
  if (!decimal || decimal->value() != size) return std::nullopt;
  for (; decimal->places > 0 && decimal->digits % 10 == 0; --decimal->places) decimal->digits /= 10;
  return decimal;
}

void append_shortest(std::string& out, double value) {
  const double size = std::fabs(value);
  if (size >= 1e-3 && size < 1e5)
    if (const auto decimal = shortest_decimal(size)) {
      out += decimal_text(decimal->digits, decimal->places, value < 0.0);
      return;
    }
  std::array<char, 40> buffer{};
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

double rounded_to_places(double value, int decimals) {
  const std::string text = fixed_text(value, decimals);
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

std::string positions_text(const std::map<std::string, double>& at) {
  std::string out;
  for (const auto& [axis, position] : at)
    out +=
        (out.empty() ? "" : " ") + axis + '=' + short_text(printed(position, Quantity::length), 9);
  return out;
}

}  // namespace nonio
