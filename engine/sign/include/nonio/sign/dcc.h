// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::sign {

/// One value of a digital calibration certificate, in the units of results.json.
struct DccValue {
  std::string analysis;  ///< "iso230-2 of X"
  std::string name;      ///< "R+"
  std::string unit;      ///< "um"
  double value = 0.0;
  std::optional<double> U{};
  double k = 2.0;  ///< coverage factor of U
};

/// The single values of a DCC 3.3.0 as Nonio writes it. What the schema lets pass is checked here:
/// every unit is one of D-SI's that are used, and all lists of a table have one length.
Expected<std::vector<DccValue>> read_dcc(std::string_view xml);

}  // namespace nonio::sign
