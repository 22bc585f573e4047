// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio::reports {

/// A result as printed, without unit.
struct Printed {
  std::string value;
  std::string U;  ///< empty if there is no uncertainty
};

/// Rounds U to two significant digits and the value to the same digit. Without U the value is
/// rounded to 0.001 of its unit, a time to 0.1 s. Arguments in SI. Values that are not finite print
/// as a dash, and from 1e9 on with an exponent. With a tolerance limit of its magnitude, the value
/// has as many digits as show on which side of the limit it is.
Printed printed_result(double value, std::optional<double> U, Quantity, std::string_view language,
                       std::optional<double> limit = {});

/// Returns the number without its printed unit.
std::string printed_number(double si, Quantity, int decimals, std::string_view language);

/// Number of decimals (at most `most`) that represent all values exactly, for target columns.
int decimals_for(const std::vector<double>& si, Quantity, int most);

/// The unit as printed: µm, °, arcsec.
std::string unit_text(Quantity);

}  // namespace nonio::reports
