// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/held_terms.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace nonio::modelling {

namespace {

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::vector<Quantity> units_for(Quantity q) {
  static constexpr std::array lengths{Quantity::deviation, Quantity::length};
  static constexpr std::array angles{Quantity::small_angle, Quantity::angular_deviation,
                                     Quantity::angle};
  std::vector<Quantity> out{q};
  const auto add = [&](const auto& all) {
    if (std::find(all.begin(), all.end(), q) == all.end()) return;
    for (const Quantity other : all)
      if (other != q) out.push_back(other);
  };
  add(lengths), add(angles);
  return out;
}

std::pair<std::optional<double>, std::string> split_value(const std::string& text) {
  const std::size_t begin = text.starts_with('+') ? 1 : 0;
  double number = 0.0;
  const auto [rest, error] =
      std::from_chars(text.data() + begin, text.data() + text.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) return {std::nullopt, text};
  return {number, trimmed(std::string(rest, text.data() + text.size()))};
}

}  // namespace

Entry entry_of(const std::string& written) {
  const std::size_t at = written.find('=');
  if (at == std::string::npos) return {written, std::nullopt};
  std::string value = trimmed(written.substr(at + 1));
  const auto [number, unit] = split_value(value);
  if (number)
    value = trimmed(value.substr(0, value.size() - unit.size())) + (unit.empty() ? "" : " " + unit);
  return {trimmed(written.substr(0, at)), value};
}

const std::string* find_effect(const std::vector<std::string>& model, const std::string& effect) {
  const std::string name = entry_of(effect).effect;
  const auto found = std::find_if(model.begin(), model.end(), [&](const std::string& written) {
    return entry_of(written).effect == name;
  });
  return found == model.end() ? nullptr : &*found;
}

Expected<double> held_value(const Entry& entry, const Effect& effect, bool rotary) {
  const std::string name = "\"" + entry.text() + "\": ";
  if (effect.curve || effect.linear.size() != 1 || !effect.shapes.empty() || effect.of_channels ||
      entry.effect.find('@') != std::string::npos)
    return fail(name +
                "only an effect with a single value can be held, such as backlash, scale or "
                "squareness; remove the value, so that it is fitted");
  const Effect::Parameter& p = effect.linear.front();
  const Quantity q = rotary ? p.rotary : p.quantity;
  std::string known;
  const auto [number, unit] = split_value(*entry.value);
  for (const Quantity one : units_for(q)) {
    const Unit u = unit_of(one);
    if (number && unit == u.symbol) return *number / u.per_si;
    known += (known.empty() ? "" : " or ") + std::string(u.symbol);
  }
  return fail(name + "expected a number" + (known.empty() ? "" : " in " + known) + ", such as " +
              entry.effect + " = 12.3" + (known.empty() ? "" : " ") +
              std::string(unit_of(q).symbol));
}

}  // namespace nonio::modelling
