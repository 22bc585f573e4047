// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio {

/// How the errors of one input quantity in the readings are correlated.
enum class Correlation {
  readings,  ///< each reading (mean) has its own
  walk,      ///< grows from reading to reading along each line, by steps of its own
  lines,     ///< one for all readings of a line, other lines have their own
  device,    ///< one for all readings of the instrument: fully correlated
};

enum class Distribution { normal, rectangular, student };

/// One input quantity of an uncertainty budget (JCGM 100:2008, 3.3 and 8), with what it does to a
/// reading.
struct Contribution {
  std::string id;  ///< its words are `budget.<id>` of templates/words
  double u = 0.0;  ///< standard uncertainty of a reading, at most; SI
  Quantity quantity = Quantity::deviation;
  bool with_length = false;  ///< proportional to the length; `u` is that of the longest one
  Distribution distribution = Distribution::normal;
  Correlation correlation = Correlation::readings;
  std::optional<double> dof{};  ///< degrees of freedom; none: known as stated
  std::string source;           ///< keys of the manifest, or "readings"
};

/// How an uncertainty came about: the inputs of an analysis, and their share in each result. U = k
/// sqrt(sum u^2), but where the laboratory's floor (its CMC) is larger; u and k of each result
/// below. Sources: JCGM 100:2008, 5.2 (correlated inputs), G.4 (degrees of freedom);
/// docs/uncertainty.md. Range: u >= 0, k > 0, dof > 0 or infinite; `check` (sdk/check.h) refuses
/// what is not finite.
struct UncertaintyBudget {
  struct Result {
    std::string name;  ///< of a value
    Quantity quantity = Quantity::number;
    std::vector<double> u;  ///< standard uncertainty in it, of each contribution
    double k = 2.0;         ///< coverage factor
    double dof = INFINITY;  ///< effective degrees of freedom (Welch-Satterthwaite)
  };
  double length = 0.0;  ///< of the longest reading, m; 0 of angles
  std::vector<Contribution> contributions;
  std::vector<Result> results;
  /// Keys of contributions that are not stated. Then no result has an uncertainty, only the
  /// repeatability of its fit.
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
