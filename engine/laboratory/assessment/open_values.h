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

/// A result that is compared with a limit.
struct Judged {
  const ShownSeries* series = nullptr;
  std::size_t result = 0;  ///< index into StoredMachine::results
};

/// All that does not conform or is indeterminate among the results of the last day on which this
/// quantity was compared with a limit; campaigns that state no limit for it replace nothing. If
/// results as left exist for that day, they replace those as found. Results without an axis are
/// replaced by those of the same measurement only: a circle in another plane replaces none.
std::vector<Judged> open_results(const store::StoredMachine& machine, const ShownSeries& series);

/// Limits for which the newest campaign that measured their axis has no value.
std::vector<const store::LimitWithoutValue*> open_limits(const store::StoredMachine& machine);

reports::OpenValue open_value(const store::StoredMachine& machine, std::size_t result);
reports::OpenValue open_value(const store::StoredMachine& machine,
                              const store::LimitWithoutValue& limit);

/// A finding that the calibration of the instrument was not valid on the day of the measurement.
bool is_calibration(std::string_view finding);

/// A table, result or certificate that was not made, or that is not to be used; or a measurement
/// with an instrument whose calibration had expired.
struct Withheld {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string axis;          ///< of a table, where it is known
  std::string finding;
  std::vector<std::string> outputs;  ///< by name
};

/// Tables of the newest campaign that measured their axis; calibrations and results that an analysis
/// refuses of the newest campaign;
/// certificates of every campaign, since each is a document of its own.
std::vector<Withheld> withheld(const store::StoredMachine& machine);

}  // namespace nonio::assessment
