// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/results.h"
#include "nonio/sdk/templates.h"
#include "nonio/sdk/units.h"

/// Formatting of numbers and texts, independent of the locale of the process.
namespace nonio {

/// The decimal number digits * 10^-places, with places from 0 to 22.
struct Decimal {
  std::int64_t digits;
  int places;
  double value() const;
};

/// Formats digits * 10^-places with all its places, preceded by "-" if it is negative and not zero.
std::string decimal_text(std::int64_t digits, int places, bool negative);

/// Formats a number with `decimals` digits after the point, rounded half away from zero:
///
///     r = sign(x) floor(|x| 10^decimals + 1/2) 10^-decimals
///
/// Rounding uses the 15 significant digits that a double preserves: 0.15 is a tie, although its
/// binary value is slightly less (IEEE 754-2019, 5.12.2). Never "-0.0". Empty if the value is not
/// finite.
std::string fixed_text(double value, int decimals);

/// Returns the number that `fixed_text` prints.
double rounded_to_places(double value, int decimals);

/// Reference for `fixed_text`, which uses a faster method: gives the same text for every finite
/// value, always from decimal digits.
std::string fixed_text_by_digits(double value, int decimals);

/// Power of ten of the second significant digit after rounding to two digits: 0.0996 rounds to
/// 0.10, which gives -2.
int place_of_second_digit(double size);

/// Rounds to a multiple of 10^place.
std::string rounded_text(double value, int place);

/// Both numbers are in the printed unit, with a decimal point.
struct RoundedResult {
  std::string value, U;
};

/// Rounds U to two significant digits (GUM, JCGM 100:2008, 7.2.6) and the value to the same place,
/// with at most 9 decimals; a smaller U is 1e-9, because no U is 0. Returns std::nullopt if U is not
/// above 0, or if a number is not finite.
std::optional<RoundedResult> rounded_result(double value, double U);

/// Uses an exponent only for an absolute value below 1e-4 (except 0) or of at least 1e9. Empty if
/// the number is not finite.
std::string short_text(double value, int significant = 3);
/// Formats axis positions (m) in mm: "X=400 Y=300".
std::string positions_text(const std::map<std::string, double>& at);

/// Rounds to 12 significant digits, ties of the exact binary value to even; never -0.
double rounded_by_digits(double value);

/// Returns the value for output files: converted from SI to its printed unit and rounded to 12
/// significant digits, so that 0.0252 m gives exactly 25.2 mm. Never -0; values that are not finite
/// are unchanged.
double printed(double si, Quantity quantity);

/// Returns the digits of the shortest text that parses to the same double, for 1e-11 <= size <
/// 1e12; std::nullopt if the fast method does not find them. `append_shortest` is for every value.
std::optional<Decimal> shortest_decimal(double size);

/// Appends the shortest text that parses to the same double, as std::to_chars writes it.
void append_shortest(std::string& out, double value);

/// Uses a decimal comma for de, it and es.
std::string localised(std::string number, std::string_view language);

/// Returns a text of templates/words/<language>/*.toml by its flattened name; empty if it does not
/// exist.
std::string words(const Templates& templates, std::string_view language, std::string_view name);

/// Formats evidence for a sentence, in its printed unit without the symbol: counts as integers,
/// positions with at most 4 decimals, a probability as "p = 0.0021" (or "p < 0.0001" for smaller
/// ones), and other numbers with about 3 significant digits. A deviation below 0.0005 becomes
/// 0.000.
std::string evidence_text(const Number& n);

/// Replaces each `{name}` in `text` by the finding's evidence of that name. The number has no unit
/// if the placeholder contains the unit, {mean_um}; the unit is added for a bare name, {mean}. A
/// placeholder without evidence is kept, so that the error is visible.
std::string filled(std::string_view text, const Finding& finding, std::string_view language);

/// Translates evidence texts. A text, or each part of a text separated by ", ", is replaced by
/// `term.<key>.<text>` of templates/words if the language contains it.
std::vector<std::pair<std::string, std::string>> said(
    const Templates& templates, std::string_view language,
    std::vector<std::pair<std::string, std::string>> texts);

/// `part` is "title", "says" or "advice". The text is in this language, otherwise in English. If
/// templates/words contains neither, the title is the id of the finding, the advice is
/// `Finding::advice`, and other parts are empty.
std::string finding_text(const Templates& templates, std::string_view language,
                         const Finding& finding, std::string_view part);

/// The text is in this language, otherwise in English, otherwise `Remark::english`.
std::string remark_text(const Templates& templates, std::string_view language,
                        const Remark& remark);

}  // namespace nonio
