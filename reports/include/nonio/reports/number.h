// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio::reports {

/// A result as it is printed, without its unit.
struct Printed {
  std::string value;
  std::string U;  ///< empty if there is none
};

/// U to two significant digits, the value to the same place; without U the value to 0.001 of its
/// printed unit, a time to 0.1 s. `value` and `U` are SI. What is not finite or not given prints as
/// a dash; beyond 1e9 a number prints with an exponent, since no table has room for more.
Printed printed_result(double value, std::optional<double> U, Quantity, std::string_view language);

/// With so many decimals, in the printed unit.
std::string printed_number(double si, Quantity, int decimals, std::string_view language);

/// The decimals (at most `most`) that show every one of the values fully, for columns of targets.
int decimals_for(const std::vector<double>& si, Quantity, int most);

/// The unit as a person writes it: µm, °, arcsec.
std::string unit_text(Quantity);

}  // namespace nonio::reports
