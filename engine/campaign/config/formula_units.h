// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "nonio/sdk/units.h"

namespace nonio::config {

struct FormulaUnit {
  Quantity quantity;
  std::string_view words;

  constexpr std::string_view symbol() const {
    const std::string_view symbol = unit_of(quantity).symbol;
    return symbol.empty() ? "1" : symbol;
  }
};

inline constexpr std::array<FormulaUnit, 18> formula_units{
    {{Quantity::deviation, "deviation"},
     {Quantity::length, "position or period"},
     {Quantity::deviation_per_length, "slope"},
     {Quantity::deviation_per_time, "drift"},
     {Quantity::growth, "growth in time"},
     {Quantity::expansion, "expansion"},
     {Quantity::angular_deviation, "deviation of an angle"},
     {Quantity::angle, "angle"},
     {Quantity::deviation_per_angle, "slope of an angle"},
     {Quantity::angle_per_time, "drift of an angle"},
     {Quantity::angular_growth, "growth of an angle in time"},
     {Quantity::angular_expansion, "expansion of an angle"},
     {Quantity::small_angle, "small angle"},
     {Quantity::deviation_per_kelvin, "drift with temperature"},
     {Quantity::angle_per_kelvin, "drift of an angle with temperature"},
     {Quantity::time, "time"},
     {Quantity::temperature_difference, "temperature difference"},
     {Quantity::number, "none: a number"}}};

/// Returns "um (deviation), mm (position or period), ..." for messages.
std::string known_units();

}  // namespace nonio::config
