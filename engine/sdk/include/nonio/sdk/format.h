// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"
#include "nonio/sdk/units.h"

/// Numbers and words as people and programs read them; the locale of the process has no part in it.
namespace nonio {

/// The powers of ten that a double holds exactly.
inline constexpr std::array<double, 23> exact_powers_of_10 = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// size * 10^places, rounded, where that is quick and sure: below 10^12, and not so near to a tie
/// that the last digits of the double could decide (they are worth less than 0.01 there).
inline std::optional<std::int64_t> quickly_rounded(double size, int places) {
  if (places < 0 || places >= static_cast<int>(exact_powers_of_10.size())) return std::nullopt;
  const double product = size * exact_powers_of_10[static_cast<std::size_t>(places)];
  if (!(product < 1e12)) return std::nullopt;
  const auto whole = static_cast<std::int64_t>(product);
  const double rest = product - static_cast<double>(whole);
  if (std::fabs(rest - 0.5) < 0.01) return std::nullopt;
  return rest > 0.5 ? whole + 1 : whole;
}

/// digits * 10^-places = a number rounded to 12 significant digits.
struct Decimal {
  std::int64_t digits;
  int places;
  double value() const {
    return static_cast<double>(digits) / exact_powers_of_10[static_cast<std::size_t>(places)];
  }
};

/// Of a size that is not negative; nothing where `quickly_rounded` gives nothing.
inline std::optional<Decimal> quick_decimal(double size) {
  if (!(size >= 1e-11 && size < 1e12)) return std::nullopt;
  int places = 11;
  while (size >= exact_powers_of_10[static_cast<std::size_t>(12 - places)]) --places;
  while (size * exact_powers_of_10[static_cast<std::size_t>(places - 11)] < 1.0) ++places;
  const auto digits = quickly_rounded(size, places);
  return digits ? std::optional(Decimal{*digits, places}) : std::nullopt;
}

/// digits * 10^-places with all its places, "-" before it if it is negative and not zero.
inline std::string decimal_text(std::int64_t digits, int places, bool negative) {
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

/// What `fixed_text` means, for every finite value.
inline std::string fixed_text_by_digits(double value, int decimals) {
  constexpr int held = 15;
  std::array<char, 32> buffer{};  // d.dddddddddddddde+xx
  const char* const end = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                        std::fabs(value), std::chars_format::scientific, held - 1)
                              .ptr;
  int exponent = 0;
  const char* const from = buffer.data() + held + 2;
  std::from_chars(*from == '+' ? from + 1 : from, end, exponent);
  std::string digits = std::string(1, buffer[0]) + std::string(buffer.data() + 2, held - 1);
  int whole = exponent + 1;  // digits before the point
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

/// With `decimals` digits after the point, half away from zero as by hand: 0.15 is a tie although
/// its binary value is a little less, so the 15 digits that a double holds are what is rounded.
/// Never "-0.0".
inline std::string fixed_text(double value, int decimals) {
  if (!std::isfinite(value)) return "";
  if (const auto digits = quickly_rounded(std::fabs(value), decimals))
    return decimal_text(*digits, decimals, value < 0.0);
  return fixed_text_by_digits(value, decimals);
}

/// A result as it is said, in the printed unit, with a decimal point: U to two significant digits
/// (GUM 7.2.6), the value to the same place. `U` is empty if there is none.
struct RoundedResult {
  std::string value, U;
};

/// The place (power of ten) of the second significant digit, after rounding to it: 0.0996 gives
/// 0.10 and so -2.
inline int place_of_second_digit(double size) {
  const int place = static_cast<int>(std::floor(std::log10(size))) - 1;
  const double carried = std::round(size / std::pow(10.0, place));
  return carried >= 100.0 ? place + 1 : place;
}

/// To a multiple of 10^place.
inline std::string rounded_text(double value, int place) {
  if (place <= 0) return fixed_text(value, -place);
  const double unit = std::pow(10.0, place);
  return fixed_text(std::round(value / unit) * unit, 0);
}

/// Nothing where U is not above 0, or no number.
inline std::optional<RoundedResult> rounded_result(double value, double U) {
  if (!(U > 0.0) || !std::isfinite(U) || !std::isfinite(value)) return std::nullopt;
  const int place = std::max(place_of_second_digit(U), -9);
  return RoundedResult{rounded_text(value, place), rounded_text(U, place)};
}

/// With about `significant` digits and without an exponent where a person expects none.
inline std::string short_text(double value, int significant = 3) {
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

/// To 12 significant digits.
inline double rounded_by_digits(double value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::scientific, 11)
                       .ptr;
  double rounded = value;
  std::from_chars(buffer.data(), end, rounded);
  return rounded == 0.0 ? 0.0 : rounded;
}

/// The value that programs get: SI converted to its printed unit, rounded to 12 significant digits
/// so that 0.0252 m gives 25.2 mm and not its neighbour.
inline double printed(double si, Quantity quantity) {
  const double value = si * unit_of(quantity).per_si;
  if (!std::isfinite(value)) return value;
  if (value == 0.0) return 0.0;  // never -0
  if (const auto decimal = quick_decimal(std::fabs(value)))
    return std::copysign(decimal->value(), value);
  return rounded_by_digits(value);
}

/// The digits of the shortest text that reads back the same; nothing where that is not quick.
inline std::optional<Decimal> shortest_decimal(double size) {
  auto decimal = quick_decimal(size);
  if (!decimal || decimal->value() != size) return std::nullopt;
  for (; decimal->places > 0 && decimal->digits % 10 == 0; --decimal->places) decimal->digits /= 10;
  return decimal;
}

/// The shortest text that reads back the same, as std::to_chars writes it.
inline void append_shortest(std::string& out, double value) {
  const double size = std::fabs(value);
  if (size >= 1e-3 && size < 1e5)  // there it has no exponent
    if (const auto decimal = shortest_decimal(size)) {
      out += decimal_text(decimal->digits, decimal->places, value < 0.0);
      return;
    }
  std::array<char, 40> buffer{};
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

/// Decimal comma for languages that use one.
inline std::string localised(std::string number, std::string_view language) {
  if (language == "it" || language == "de" || language == "es")
    std::replace(number.begin(), number.end(), '.', ',');
  return number;
}

/// A text of templates/words/<language>/*.toml by its flattened name; empty if there is none.
inline std::string words(const Templates& templates, std::string_view language,
                         std::string_view name) {
  const std::string folder = "words/" + std::string(language) + "/";
  for (auto it = templates.tables.lower_bound(folder);
       it != templates.tables.end() && it->first.compare(0, folder.size(), folder) == 0; ++it)
    if (it->second.has(name)) return it->second.text(name);
  return {};
}

/// The number of a finding in a sentence: counts are whole, positions keep their digits, and a
/// probability is "p = 0.0021" down to what nobody can picture.
inline std::string evidence_text(const Number& n) {
  const double value = printed(n.value, n.quantity);
  if (n.quantity == Quantity::count) return fixed_text(value, 0);
  if (n.quantity == Quantity::probability)
    return value < 1e-4 ? "p < 0.0001" : "p = " + short_text(value, 2);
  const bool deviation =
      n.quantity == Quantity::deviation || n.quantity == Quantity::angular_deviation;
  if (deviation && std::fabs(value) < 5e-4) return fixed_text(0.0, 3);  // no exponent for rounding
  if (n.quantity != Quantity::length && n.quantity != Quantity::angle) return short_text(value);
  std::string text = fixed_text(value, 4);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

/// `text` with each `{name}` replaced by the finding's evidence of that name (numbers carry their
/// unit in the name: {mean_um}; by the bare name, {mean}, a number comes with its unit, whatever
/// that is). A place without evidence stays as it is, to be seen.
inline std::string filled(std::string_view text, const Finding& finding,
                          std::string_view language) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t close = text[i] == '{' ? text.find('}', i) : std::string_view::npos;
    if (close == std::string_view::npos) {
      out += text[i++];
      continue;
    }
    const std::string_view name = text.substr(i + 1, close - i - 1);
    std::string value(text.substr(i, close + 1 - i));
    for (const Number& n : finding.evidence)
      if (name == n.name + std::string(unit_of(n.quantity).suffix))
        value = localised(evidence_text(n), language);
      else if (name == n.name)
        value =
            localised(evidence_text(n), language) + " " + std::string(unit_of(n.quantity).symbol);
    for (const auto& [key, words_of] : finding.texts)
      if (name == key) value = words_of;
    out += value;
    i = close + 1;
  }
  return out;
}

/// Texts of a finding that are names out of a list, in words where the language has some:
/// `term.<key>.<text>` of templates/words.
inline std::vector<std::pair<std::string, std::string>> said(
    const Templates& templates, std::string_view language,
    std::vector<std::pair<std::string, std::string>> texts) {
  for (auto& [key, text] : texts)
    if (std::string term = words(templates, language, "term." + key + "." + text); !term.empty())
      text = std::move(term);
  return texts;
}

/// The words for a finding: part is "title", "says" or "advice".
inline std::string finding_text(const Templates& templates, std::string_view language,
                                const Finding& finding, std::string_view part) {
  std::string text = words(templates, language, "finding." + finding.id + "." + std::string(part));
  if (text.empty() && language != "en")
    text = words(templates, "en", "finding." + finding.id + "." + std::string(part));
  if (text.empty()) return part == "advice" ? finding.advice : part == "title" ? finding.id : "";
  Finding in_words = finding;
  in_words.texts = said(templates, language, std::move(in_words.texts));
  return filled(text, in_words, language);
}

/// The words for a remark; `english` where there are none.
inline std::string remark_text(const Templates& templates, std::string_view language,
                               const Remark& remark) {
  std::string text = words(templates, language, "note." + remark.id);
  if (text.empty() && language != "en") text = words(templates, "en", "note." + remark.id);
  if (text.empty()) return remark.english;
  return filled(text, {.id = remark.id, .evidence = remark.evidence, .texts = remark.texts},
                language);
}

}  // namespace nonio
