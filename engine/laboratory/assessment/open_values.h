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

/// A result that was compared with a limit.
struct Judged {
  const ShownSeries* series = nullptr;
  std::size_t result = 0;  ///< index into StoredMachine::results
};

/// Returns the results that do not conform or are indeterminate on the last day on which this
/// quantity was compared with a limit. Campaigns without a limit for it are ignored. If results as
/// left exist for that day, they replace those as found. Results without an axis are replaced only
/// by those of the same measurement: a circle in another plane does not replace them.
std::vector<Judged> open_results(const store::StoredMachine& machine, const ShownSeries& series);

/// Returns limits for which the newest campaign that measured their axis has no value. A limit
/// without an axis is returned until all axes of its campaign are measured again.
std::vector<const store::LimitWithoutValue*> open_limits(const store::StoredMachine& machine);

reports::OpenValue open_value(const store::StoredMachine& machine, std::size_t result);
reports::OpenValue open_value(const store::StoredMachine& machine,
                              const store::LimitWithoutValue& limit);

/// Whether a finding reports that the instrument's calibration was not valid on the day of the
/// measurement.
bool is_calibration(std::string_view finding);

/// A table, result or certificate that was not made or must not be used, or a measurement whose
/// instrument's calibration had expired.
struct Withheld {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string axis;          ///< axis of a table; empty: it is unknown, or no table is withheld
  std::string finding;
  std::vector<std::string> outputs;  ///< names of the plugins that make the outputs
};

/// Returns tables withheld in the newest campaign that measured their axis; results withheld by an
/// analysis and expired calibrations, unless all axes of their campaign were measured again later;
/// and certificates withheld in any campaign, since each certificate is an independent document.
std::vector<Withheld> withheld(const store::StoredMachine& machine);

}  // namespace nonio::assessment
