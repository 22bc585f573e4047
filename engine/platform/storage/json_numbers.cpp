// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/json_numbers.h"

namespace nonio::storage {

Number number_of(const std::string& key, const Json& value) {
  Number n{key, value.get<double>(),
           value.is_number_integer()             ? Quantity::count
           : key == "p" || key.starts_with("p_") ? Quantity::probability
                                                 : Quantity::number};
  std::size_t longest = 0;
  for (int i = 0; i <= static_cast<int>(Quantity::angle_per_kelvin); ++i) {
    const Unit unit = unit_of(static_cast<Quantity>(i));
    if (unit.suffix.size() <= longest || !key.ends_with(unit.suffix)) continue;
    longest = unit.suffix.size();
    n.quantity = static_cast<Quantity>(i);
  }
  n.name.resize(key.size() - longest);
  n.value /= unit_of(n.quantity).per_si;
  return n;
}

std::optional<Number> get(const Json& json, const std::string& name) {
  for (const auto& [key, value] : json.items()) {
    if (!key.starts_with(name) || !value.is_number()) continue;
    if (Number n = number_of(key, value); n.name == name) return n;
  }
  return std::nullopt;
}

}  // namespace nonio::storage
