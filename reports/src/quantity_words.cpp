// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/quantity_words.h"

namespace nonio::reports {

std::string followed_quantity(const Wording& site, const std::string& quantity) {
  const auto colon = quantity.find(':');
  const std::string kind = quantity.substr(0, colon);
  // "iso-1988:A": a value of a rule, with the standard's name.
  if (const std::string rule = site.get_or("site.rule." + kind, "");
      !rule.empty() && colon != std::string::npos) {
    const std::string symbol = quantity.substr(colon + 1);
    return (symbol.starts_with("+-") ? "± " + symbol.substr(2) : symbol) + ", " + rule;
  }
  const std::string name = site.get_or("site.quantity." + kind, quantity);
  if (name == quantity || colon == std::string::npos) return name;
  // "straightness:Z.curve_2": of which movement, and which part of it.
  const auto dot = quantity.find('.', colon);
  const std::string of = name + " " + quantity.substr(colon + 1, dot - colon - 1);
  if (dot == std::string::npos || quantity.substr(dot + 1) == "c") return of;
  const std::string part = quantity.substr(dot + 1);
  return of + ", " + site.get_or("site.part." + part, part);
}

bool is_log_of_scatter(const std::string& quantity) {
  return quantity == "ln_s" || quantity.ends_with(".ln_s");
}

std::string event_text(const Wording& site, const std::string& event) {
  const std::string kind = event.substr(0, event.find(": "));
  return site.get_or("site.event." + kind, kind) + event.substr(kind.size());
}

}  // namespace nonio::reports
