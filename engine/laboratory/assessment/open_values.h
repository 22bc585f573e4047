// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

inline constexpr const char* conforms = "conforms";
inline constexpr const char* does_not_conform = "does not conform";

struct Judged {
  const ShownSeries* series = nullptr;
  std::size_t result = 0;  ///< index into StoredMachine::results
};

/// Returns the results that do not conform or are indeterminate on the last date with a decision.
/// On this date, results as left replace those as found. Results without an axis are replaced only
/// by those of the same measurement, because a circle in another plane is another result.
std::vector<Judged> open_results(const store::StoredMachine& machine, const ShownSeries& series);

/// Returns limits without a value in the newest campaign of their axis. A limit without an axis
/// applies until all axes of its campaign are measured again.
std::vector<const store::LimitWithoutValue*> open_limits(const store::StoredMachine& machine);

reports::OpenValue open_value(const store::StoredMachine& machine, std::size_t result);
reports::OpenValue open_value(const store::StoredMachine& machine,
                              const store::LimitWithoutValue& limit);

/// Whether the finding reports that the calibration of the instrument was not valid.
bool is_calibration(std::string_view finding);

/// A table, result or certificate that was not issued or must not be used, or an expired
/// calibration of the instrument.
struct Withheld {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string axis;          ///< axis of a table, if known
  std::string finding;
  std::vector<std::string> outputs;
};

/// Returns tables withheld in the newest campaign of their axis, results withheld and calibrations
/// expired in campaigns whose axes were not all measured again, and certificates withheld in any
/// campaign, because each certificate is an independent document.
std::vector<Withheld> withheld(const store::StoredMachine& machine);

}  // namespace nonio::assessment
