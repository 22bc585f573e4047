// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio {

namespace {

using Texts = std::vector<std::pair<std::string, std::string>>;

}  // namespace

std::string localised(std::string number, std::string_view language) {
  if (language == "it" || language == "de" || language == "es")
    std::replace(number.begin(), number.end(), '.', ',');
  return number;
}

std::string words(const Templates& templates, std::string_view language, std::string_view name) {
  return templates.tables.text(language, name);
}

std::string evidence_text(const Number& n) {
  const double value = printed(n.value, n.quantity);
  if (n.quantity == Quantity::count) return fixed_text(value, 0);
  if (n.quantity == Quantity::probability)
    return value < 1e-4 ? "p < 0.0001" : "p = " + short_text(value, 2);
  const bool deviation =
      n.quantity == Quantity::deviation || n.quantity == Quantity::angular_deviation;
  // A rounding error is written as 0.000, not as a number with an exponent.
  if (deviation && std::fabs(value) < 5e-4) return fixed_text(0.0, 3);
  if (n.quantity != Quantity::length && n.quantity != Quantity::angle) return short_text(value);
  std::string text = fixed_text(value, 4);
  text.erase(text.find_last_not_of('0') + 1);
  if (!text.empty() && text.back() == '.') text.pop_back();
  return text;
}

namespace {

bool is_joined(std::string_view joined, std::string_view name, std::string_view suffix) {
  return joined.size() == name.size() + suffix.size() && joined.starts_with(name) &&
         joined.ends_with(suffix);
}

/// Replaces the decimal points between digits.
std::string with_local_numbers(std::string text, std::string_view language) {
  const auto is_digit = [&](std::size_t i) { return text[i] >= '0' && text[i] <= '9'; };
  for (std::size_t i = 1; i + 1 < text.size(); ++i)
    if (text[i] == '.' && is_digit(i - 1) && is_digit(i + 1)) text[i] = localised(".", language)[0];
  return text;
}

/// Whether the text contains numbers, such as "1.00 EYZ.2" or the positions of readings, and not the
/// name of a measurement.
bool has_numbers(std::string_view key, const std::string& text) {
  return key == "combinations" || key == "weakest" ||
         (key == "which" && (text.find(" mm") != text.npos || text.find(" deg") != text.npos));
}

constexpr std::string_view plus_minus = "\u00b1";

/// "{value\u00b1U}": a value with its U, both in the unit of the value and rounded to the second digit of
/// U. With a name such as "value_ms" there is no unit.
std::optional<std::string> with_U(const std::vector<Number>& evidence, std::string_view name,
                                  std::string_view name_of_U, std::string_view language) {
  const auto found = [&](std::string_view wanted) {
    return std::find_if(evidence.begin(), evidence.end(),
                        [&](const Number& n) { return n.name == wanted; });
  };
  const auto value = found(name), U = found(name_of_U);
  if (value == evidence.end() || U == evidence.end()) return std::nullopt;
  const std::string symbol(unit_of(value->quantity).symbol);
  const auto both =
      rounded_result(printed(value->value, value->quantity), printed(U->value, value->quantity));
  const std::string text =
      both ? both->value + " " + std::string(plus_minus) + " " + both->U : evidence_text(*value);
  return localised(text, language) + (symbol.empty() ? "" : " " + symbol);
}

std::string filled(std::string_view text, const std::vector<Number>& evidence, const Texts& texts,
                   std::string_view language) {
  std::string out;
  out.reserve(text.size() + text.size() / 4);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t open = std::min(text.find('{', i), text.size());
    out += text.substr(i, open - i);
    i = open;
    if (i == text.size()) break;
    const std::size_t close = text.find('}', i);
    if (close == std::string_view::npos) {
      out += text[i++];
      continue;
    }
    const std::string_view name = text.substr(i + 1, close - i - 1);
    std::string value(text.substr(i, close + 1 - i));
    if (const std::size_t at = name.find(plus_minus); at != std::string_view::npos)
      value = with_U(evidence, name.substr(0, at), name.substr(at + plus_minus.size()), language)
                  .value_or(value);
    for (const Number& n : evidence)
      if (is_joined(name, n.name, unit_of(n.quantity).suffix))
        value = localised(evidence_text(n), language);
      else if (is_joined(name, n.name, "%"))  // a ratio
        value = localised(short_text(100.0 * n.value, 2), language) + " %";
      else if (name == n.name)
        value =
            localised(evidence_text(n), language) + " " + std::string(unit_of(n.quantity).symbol);
    for (const auto& [key, words_of] : texts)
      if (name == key)
        value = has_numbers(key, words_of) ? with_local_numbers(words_of, language) : words_of;
    out += value;
    i = close + 1;
  }
  return out;
}

}  // namespace

std::string filled(std::string_view text, const Finding& finding, std::string_view language) {
  return filled(text, finding.evidence, finding.texts, language);
}

Texts said(const Templates& templates, std::string_view language, Texts texts) {
  for (auto& [key, text] : texts) {
    std::string out;
    for (std::size_t at = 0; at <= text.size();) {
      const std::size_t end = std::min(text.find(", ", at), text.size());
      const std::string one = text.substr(at, end - at);
      const std::string term = words(templates, language, "term." + key + "." + one);
      out += (at == 0 ? "" : ", ") + (term.empty() ? one : term);
      at = end + 2;
    }
    if (std::string term = words(templates, language, "term." + key + "." + text); !term.empty())
      out = std::move(term);
    text = std::move(out);
  }
  return texts;
}

std::string finding_text(const Templates& templates, std::string_view language,
                         const Finding& finding, std::string_view part) {
  std::string text = words(templates, language, "finding." + finding.id + "." + std::string(part));
  if (text.empty() && language != "en")
    text = words(templates, "en", "finding." + finding.id + "." + std::string(part));
  if (text.empty()) return part == "advice" ? finding.advice : part == "title" ? finding.id : "";
  return filled(text, finding.evidence, said(templates, language, finding.texts), language);
}

std::string remark_text(const Templates& templates, std::string_view language,
                        const Remark& remark) {
  std::string text = words(templates, language, "note." + remark.id);
  if (text.empty() && language != "en") text = words(templates, "en", "note." + remark.id);
  if (text.empty()) return remark.english;
  return filled(text, remark.evidence, remark.texts, language);
}

}  // namespace nonio
