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
  std::string analysis;  ///< analysis of the value, for example "iso230-2 of X"
  std::string name;      ///< name of the value, for example "R+"
  std::string unit;
  double value = 0.0;
  std::optional<double> U{};
  double k = 2.0;  ///< coverage factor of U
};

/// Reads the single values of a DCC 3.3.0 as Nonio writes it. Returns an error for a document
/// without values, for a unit that is not one of the D-SI units of Nonio, or if the lists of a
/// table differ in length.
Expected<std::vector<DccValue>> read_dcc(std::string_view xml);

}  // namespace nonio::sign
