// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/series.h"
#include "laboratory/statistics/forecast.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Returns the quantity that has this unit symbol in results.json; Quantity::number for an unknown
/// symbol.
Quantity quantity_of_unit(const std::string& symbol);
/// Converts a value from the printed unit to SI, so that `printed` restores the same number.
double si(double shown, Quantity quantity);

/// Returns the name of a machine's page in OUT/machines: valid as a file name everywhere, and
/// different for each machine.
std::string page_of_machine(const std::string& machine);

/// Finds where a campaign's results are, relative to the output folder: its report if it has one,
/// otherwise its results.json.
class Links {
 public:
  explicit Links(const std::filesystem::path& out);
  std::string of(const std::string& campaign) const;

 private:
  std::string root_;
  bool hashed_;
  bool packed_ = true;  ///< whether reports may be in packs
};
std::string link_of(const std::filesystem::path& out, const std::string& campaign);

/// Returns the median gap between campaign days, in days (of two middle gaps the larger); none for
/// fewer than two days.
std::optional<std::int64_t> usual_interval(const std::vector<store::StoredCampaign>& campaigns);

/// The limit that applies to a followed quantity, in the unit of results.json: its own limit, or
/// for B_mean that of B, with the amount by which B exceeds |B_mean|.
struct FollowedLimit {
  std::string quantity;  ///< quantity that the limit is stated for
  double limit = 0.0;
  nonio::statistics::Beyond beyond{};
};
/// Returns the limit of the quantity of `series`; for B_mean the limit of B, if B has one and was
/// measured together with B_mean since the last significant change. None if there is no limit, or
/// if the series with the limit has ended.
std::optional<FollowedLimit> limit_of(const AssessedMachine& machine, const FollowedSeries& series);

/// Returns whether the table was loaded on this axis and the days between which it was loaded
/// overlap with those between which the change occurred.
bool is_at(const reports::TableLoaded& table, const std::string& axis,
           const reports::HistoryChange& change);

/// Describes a machine for pages and programs. `due`: day of the next calibration by a rule; `why`:
/// the interval of that rule in months, as text. If `due` is empty there is no rule, and forecasts
/// look one usual interval ahead. A forecast for a day before `today` is marked as overdue, unless
/// it has no answer or a value of the axis is out of its limit or indeterminate.
reports::MachineHistory describe(const AssessedMachine& machine, const std::filesystem::path& out,
                                 const std::string& due, const std::string& why,
                                 const std::string& today = {});

}  // namespace nonio::assessment
