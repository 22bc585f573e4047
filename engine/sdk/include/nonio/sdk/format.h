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

/// Numbers and words as people and programs read them; the locale of the process has no part in it.
namespace nonio {

/// digits * 10^-places, exactly; places is 0 to 22.
struct Decimal {
  std::int64_t digits;
  int places;
  double value() const;
};

/// digits * 10^-places with all its places, "-" before it if it is negative and not zero.
std::string decimal_text(std::int64_t digits, int places, bool negative);

/// Round half away from zero, to `decimals` digits after the point:
///
///     r = sign(x) floor(|x| 10^decimals + 1/2) 10^-decimals
///
/// of the 15 significant digits that a double holds: 0.15 is a tie, although its binary value is a
/// little less (IEEE 754-2019, 5.12.2: 15 digits survive). Never "-0.0". Empty if it is not finite.
std::string fixed_text(double value, int decimals);

/// The number that `fixed_text` shows.
double rounded_to_places(double value, int decimals);

/// What `fixed_text` gives, without its quick way, for every finite value.
std::string fixed_text_by_digits(double value, int decimals);

/// The place (power of ten) of the second significant digit, after rounding to it: 0.0996 gives
/// 0.10 and so -2.
int place_of_second_digit(double size);

/// To a multiple of 10^place.
std::string rounded_text(double value, int place);

/// A result in the printed unit, with a decimal point.
struct RoundedResult {
  std::string value, U;
};

/// U to two significant digits (GUM, JCGM 100:2008, 7.2.6), the value to the same place, at most 9
/// places behind the point. Nothing where U is not above 0, or either is no finite number.
std::optional<RoundedResult> rounded_result(double value, double U);

/// With about `significant` digits, without an exponent from 1e-4 to 1e9. Empty if it is not
/// finite.
std::string short_text(double value, int significant = 3);
/// Positions of axes, in m, as "X=400 Y=300" in mm.
std::string positions_text(const std::map<std::string, double>& at);

/// To 12 significant digits, half to even of its exact binary value; never -0.
double rounded_by_digits(double value);

/// The value that programs get: SI converted to its printed unit, rounded to 12 significant digits,
/// so that 0.0252 m gives 25.2 mm and not its neighbour. Never -0; what is not finite stays so.
double printed(double si, Quantity quantity);

/// The digits of the shortest text that reads back the same, for 1e-11 <= size < 1e12; nothing
/// where they are not found quickly. Then `append_shortest` finds them.
std::optional<Decimal> shortest_decimal(double size);

/// The shortest text that reads back the same, as std::to_chars writes it.
void append_shortest(std::string& out, double value);

/// Decimal comma for languages that use one.
std::string localised(std::string number, std::string_view language);

/// A text of templates/words/<language>/*.toml by its flattened name; empty if there is none.
std::string words(const Templates& templates, std::string_view language, std::string_view name);

/// The number of a finding in a sentence: counts are whole, positions keep their digits, and a
/// probability is "p = 0.0021", or "p < ..." below a smallest printed value.
std::string evidence_text(const Number& n);

/// `text` with each `{name}` replaced by the finding's evidence of that name (numbers carry their
/// unit in the name: {mean_um}; by the bare name, {mean}, a number comes with its unit, whatever
/// that is). A placeholder without evidence stays as it is, to be seen.
std::string filled(std::string_view text, const Finding& finding, std::string_view language);

/// Texts of a finding that are names out of a list, in words where the language has some:
/// `term.<key>.<text>` of templates/words.
std::vector<std::pair<std::string, std::string>> said(
    const Templates& templates, std::string_view language,
    std::vector<std::pair<std::string, std::string>> texts);

/// The words for a finding: part is "title", "says" or "advice".
std::string finding_text(const Templates& templates, std::string_view language,
                         const Finding& finding, std::string_view part);

/// The words for a remark; `english` where there are none.
std::string remark_text(const Templates& templates, std::string_view language,
                        const Remark& remark);

}  // namespace nonio
