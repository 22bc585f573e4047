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

/// Returns the quantity with this unit symbol in results.json, or Quantity::number for an unknown
/// symbol.
Quantity quantity_of_unit(const std::string& symbol);
/// Converts a value from the printed unit to SI, so that `printed` restores the same number.
double si(double shown, Quantity quantity);

/// Returns the file name of the page in OUT/machines, which is portable and unique.
std::string page_of_machine(const std::string& machine);

/// Returns the path of report.pdf of a campaign, or of its results.json if there is no report,
/// relative to the output folder.
class Links {
 public:
  explicit Links(const std::filesystem::path& out);
  std::string of(const std::string& campaign) const;

 private:
  std::string root_;
  bool hashed_;
  bool packed_ = true;  ///< whether packs may contain reports
};
std::string link_of(const std::filesystem::path& out, const std::string& campaign);

/// Returns the median interval between the dates of campaigns in days (the larger one of two middle
/// values); std::nullopt for fewer than two dates.
std::optional<std::int64_t> usual_interval(const std::vector<store::StoredCampaign>& campaigns);

/// Limit of a followed quantity in the unit of results.json. The limit of B_mean can be that of B,
/// with the amount by which B exceeds |B_mean|.
struct FollowedLimit {
  std::string quantity;  ///< quantity with the limit
  double limit = 0.0;
  nonio::statistics::Beyond beyond{};
};
/// Returns the limit of the quantity; for B_mean that of B, if both were measured together since
/// the last significant change. std::nullopt without a limit.
std::optional<FollowedLimit> limit_of(const AssessedMachine& machine, const FollowedSeries& series);
/// std::nullopt also if a followed quantity has this limit.
std::optional<FollowedLimit> limit_of(const AssessedMachine& machine, const ShownSeries& series);

/// Whether the table was loaded on this axis between dates that overlap with those of the change.
bool is_at(const reports::TableLoaded& table, const std::string& axis,
           const reports::HistoryChange& change);

/// Describes a machine for pages and JSON. `due` is the due date by a rule, `why` the interval of
/// the rule in months. Without a rule, forecasts are for the usual interval after the last
/// campaign. A forecast for a date before `today` is marked as overdue, unless it has no answer or
/// a value is out of tolerance or indeterminate.
reports::MachineHistory describe(const AssessedMachine& machine, const std::filesystem::path& out,
                                 const std::string& due, const std::string& why,
                                 const std::string& today = {});

}  // namespace nonio::assessment
