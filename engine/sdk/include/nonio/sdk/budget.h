// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio {

/// Correlation of the errors of one input quantity between readings.
enum class Correlation {
  readings,  ///< independent for each reading, so that averaging reduces the error
  walk,      ///< a random walk along each line, independent between lines
  lines,     ///< fully correlated within a line, independent between lines
  device,    ///< fully correlated for all readings of the instrument
};

enum class Distribution { normal, rectangular, student };

/// One input quantity of an uncertainty budget (JCGM 100:2008, 3.3 and 8) and its effect on a
/// reading.
struct Contribution {
  std::string id;  ///< the text is `budget.<id>` in templates/words
  double u = 0.0;  ///< largest standard uncertainty of a reading due to it, SI
  Quantity quantity = Quantity::deviation;
  /// Whether `u` is proportional to length; it is then the value for the longest length.
  bool with_length = false;
  Distribution distribution = Distribution::normal;
  Correlation correlation = Correlation::readings;
  std::optional<double> dof{};  ///< degrees of freedom; absent if `u` is exact
  std::string source;           ///< manifest keys that state the quantity, or "readings"
};

/// Uncertainty budget of an analysis. U = k sqrt(sum u^2), unless the laboratory's smallest
/// uncertainty (CMC) is larger. Sources: JCGM 100:2008, 5.2 (correlated inputs), G.4 (degrees of
/// freedom); docs/uncertainty.md. Range: u >= 0, k > 0, dof > 0 or infinite; `check` (sdk/check.h)
/// tests only that each result has one u per contribution.
struct UncertaintyBudget {
  struct Result {
    std::string name;  ///< `Value::name` of the result
    Quantity quantity = Quantity::number;
    std::vector<double> u;  ///< standard uncertainty due to each contribution, SI
    double k = 2.0;
    double dof = INFINITY;  ///< effective degrees of freedom (Welch-Satterthwaite)
  };
  double length = 0.0;  ///< length of the longest reading, m; 0 for angles
  std::vector<Contribution> contributions;
  std::vector<Result> results;
  /// Keys of contributions that the manifest does not state. If there are any, results have only a
  /// repeatability, not an uncertainty.
  std::vector<std::string> missing;
};

constexpr std::string_view to_text(Correlation c) {
  switch (c) {
    case Correlation::readings:
      return "readings";
    case Correlation::walk:
      return "walk";
    case Correlation::lines:
      return "lines";
    case Correlation::device:
      break;
  }
  return "device";
}

constexpr std::string_view to_text(Distribution d) {
  return d == Distribution::normal        ? "normal"
         : d == Distribution::rectangular ? "rectangular"
                                          : "student";
}

}  // namespace nonio
