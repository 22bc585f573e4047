// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/units.h"

namespace nonio {

/// How the errors of one input quantity are correlated between readings.
enum class Correlation {
  readings,  ///< independent in each reading, so that a mean of readings reduces them
  walk,      ///< a random walk along each line, independent between lines
  lines,     ///< the same for all readings of a line, independent between lines
  device,    ///< the same for all readings of the instrument: fully correlated
};

enum class Distribution { normal, rectangular, student };

/// One input quantity of an uncertainty budget (JCGM 100:2008, 3.3 and 8), and its effect on a
/// reading.
struct Contribution {
  std::string id;  ///< name of its text, `budget.<id>` of templates/words
  double u = 0.0;  ///< largest standard uncertainty that it causes in a reading; SI
  Quantity quantity = Quantity::deviation;
  /// whether it is proportional to length; `u` is then its value at the longest length
  bool with_length = false;
  Distribution distribution = Distribution::normal;
  Correlation correlation = Correlation::readings;
  std::optional<double> dof{};  ///< degrees of freedom; none: `u` is taken as exactly known
  std::string source;           ///< keys of the manifest that state it, or "readings"
};

/// The uncertainty budget of an analysis: its input quantities and their contribution to each
/// result. U = k sqrt(sum u^2), unless the laboratory's smallest uncertainty (its CMC) is larger.
/// Sources: JCGM 100:2008, 5.2 (correlated inputs), G.4 (degrees of freedom); docs/uncertainty.md.
/// Range: u >= 0, k > 0, dof > 0 or infinite; `check` (sdk/check.h) tests only that each result has
/// one u per contribution.
struct UncertaintyBudget {
  struct Result {
    std::string name;  ///< name of the value (`Value::name`)
    Quantity quantity = Quantity::number;
    std::vector<double> u;  ///< standard uncertainty of the result caused by each contribution, SI
    double k = 2.0;         ///< coverage factor
    double dof = INFINITY;  ///< effective degrees of freedom (Welch-Satterthwaite)
  };
  double length = 0.0;  ///< length of the longest reading, m; 0 for angles
  std::vector<Contribution> contributions;
  std::vector<Result> results;
  /// Keys of contributions that the manifest does not state. If there are any, no result has an
  /// uncertainty, only the repeatability of its fit.
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
