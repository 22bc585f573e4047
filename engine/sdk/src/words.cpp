// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio {

std::string localised(std::string number, std::string_view language) {
  if (language == "it" || language == "de" || language == "es")
    std::replace(number.begin(), number.end(), '.', ',');
  return number;
}

std::string words(const Templates& templates, std::string_view language, std::string_view name) {
  const std::string folder = "words/" + std::string(language) + "/";
  for (auto it = templates.tables.lower_bound(folder);
       it != templates.tables.end() && it->first.compare(0, folder.size(), folder) == 0; ++it)
    if (it->second.has(name)) return it->second.text(name);
  return {};
}

std::string evidence_text(const Number& n) {
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

std::string filled(std::string_view text, const Finding& finding, std::string_view language) {
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

std::vector<std::pair<std::string, std::string>> said(
    const Templates& templates, std::string_view language,
    std::vector<std::pair<std::string, std::string>> texts) {
  for (auto& [key, text] : texts)
    if (std::string term = words(templates, language, "term." + key + "." + text); !term.empty())
      text = std::move(term);
  return texts;
}

std::string finding_text(const Templates& templates, std::string_view language,
                         const Finding& finding, std::string_view part) {
  std::string text = words(templates, language, "finding." + finding.id + "." + std::string(part));
  if (text.empty() && language != "en")
    text = words(templates, "en", "finding." + finding.id + "." + std::string(part));
  if (text.empty()) return part == "advice" ? finding.advice : part == "title" ? finding.id : "";
  Finding in_words = finding;
  in_words.texts = said(templates, language, std::move(in_words.texts));
  return filled(text, in_words, language);
}

std::string remark_text(const Templates& templates, std::string_view language,
                        const Remark& remark) {
  std::string text = words(templates, language, "note." + remark.id);
  if (text.empty() && language != "en") text = words(templates, "en", "note." + remark.id);
  if (text.empty()) return remark.english;
  return filled(text, {.id = remark.id, .evidence = remark.evidence, .texts = remark.texts},
                language);
}

}  // namespace nonio
