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
#include "nonio/sdk/settings.h"
#include "nonio/sdk/units.h"

/// Formats numbers and texts for people and programs, independently of the locale of the process.
namespace nonio {

/// A decimal number: exactly digits * 10^-places, with places from 0 to 22.
struct Decimal {
  std::int64_t digits;
  int places;
  double value() const;
};

/// Writes digits * 10^-places with all its places, preceded by "-" if it is negative and not zero.
std::string decimal_text(std::int64_t digits, int places, bool negative);

/// Writes a number with `decimals` digits after the point, rounded half away from zero:
///
///     r = sign(x) floor(|x| 10^decimals + 1/2) 10^-decimals
///
/// Rounding uses the 15 significant digits that a double preserves: 0.15 is a tie, although its
/// binary value is slightly less (IEEE 754-2019, 5.12.2). Never "-0.0". Empty if the value is not
/// finite.
std::string fixed_text(double value, int decimals);

/// Returns the number that `fixed_text` prints.
double rounded_to_places(double value, int decimals);

/// Returns the same text as `fixed_text` for every finite value, but always computes it from
/// decimal digits; it is the reference for the faster method of `fixed_text`.
std::string fixed_text_by_digits(double value, int decimals);

/// Returns the power of ten of the second significant digit, after rounding to two digits: 0.0996
/// rounds to 0.10, which gives -2.
int place_of_second_digit(double size);

/// Writes the value rounded to a multiple of 10^place.
std::string rounded_text(double value, int place);

/// The texts of a value and its U in the printed unit, with a decimal point.
struct RoundedResult {
  std::string value, U;
};

/// Rounds U to two significant digits (GUM, JCGM 100:2008, 7.2.6) and the value to the same place,
/// at most 9 places after the point. Nothing if U is not above 0, or if either is not finite.
std::optional<RoundedResult> rounded_result(double value, double U);

/// Writes a number with about `significant` digits; with an exponent only if its size is below 1e-4
/// (except 0), or 1e9 and above. Empty if the number is not finite.
std::string short_text(double value, int significant = 3);
/// Writes positions of axes, given in m, in mm: "X=400 Y=300".
std::string positions_text(const std::map<std::string, double>& at);

/// Rounds to 12 significant digits, ties of the exact binary value to even; never -0.
double rounded_by_digits(double value);

/// Returns the value in output files: SI converted to its printed unit and rounded to 12
/// significant digits, so that 0.0252 m gives exactly 25.2 mm. Never -0; values that are not finite
/// are unchanged.
double printed(double si, Quantity quantity);

/// Returns the digits of the shortest text that parses to the same double, for 1e-11 <= size <
/// 1e12; nothing if the fast method does not find them. `append_shortest` handles every value.
std::optional<Decimal> shortest_decimal(double size);

/// Appends the shortest text that parses to the same double, as std::to_chars writes it.
void append_shortest(std::string& out, double value);

/// Replaces the decimal point by a comma for languages that use a comma (de, it, es).
std::string localised(std::string number, std::string_view language);

/// Returns a text of templates/words/<language>/*.toml by its flattened name; empty if there is
/// none.
std::string words(const Templates& templates, std::string_view language, std::string_view name);

/// Writes a number of a finding for a sentence, in its printed unit without the symbol: counts as
/// integers, positions with at most 4 decimals, a probability as "p = 0.0021", or "p < 0.0001"
/// below that value, and other numbers with about 3 significant digits. A deviation below 0.0005 is
/// written as 0.000.
std::string evidence_text(const Number& n);

/// Replaces each `{name}` in `text` by the finding's evidence of that name. A number whose
/// placeholder names a unit, {mean_um}, is written without unit; with the bare name, {mean}, its
/// unit is added. A placeholder without evidence is kept, so that the error is visible.
std::string filled(std::string_view text, const Finding& finding, std::string_view language);

/// Returns the evidence texts of a finding, translated. A text, or each part of a text separated by
/// ", ", is replaced by `term.<key>.<text>` of templates/words if the language has it.
std::vector<std::pair<std::string, std::string>> said(
    const Templates& templates, std::string_view language,
    std::vector<std::pair<std::string, std::string>> texts);

/// Returns a text of a finding in this language, else in English; `part` is "title", "says" or
/// "advice". If templates/words has neither, the title is the id of the finding, the advice is
/// `Finding::advice`, and other parts are empty.
std::string finding_text(const Templates& templates, std::string_view language,
                         const Finding& finding, std::string_view part);

/// Returns the text of a remark in this language, else in English, else `Remark::english`.
std::string remark_text(const Templates& templates, std::string_view language,
                        const Remark& remark);

}  // namespace nonio
