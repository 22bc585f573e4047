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

/// Of a unit's symbol in results.json.
Quantity quantity_of_unit(const std::string& symbol);
/// From the printed unit to SI, so that `printed` gives the number back.
double si(double shown, Quantity quantity);

/// The page of a machine in OUT/machines: a name that is a file's everywhere, and one machine's
/// only.
std::string page_of_machine(const std::string& machine);

/// Where the results of campaigns are, relative to the output folder: the report, else the folder's
/// results.json.
class Links {
 public:
  explicit Links(const std::filesystem::path& out);
  std::string of(const std::string& campaign) const;

 private:
  std::string root_;
  bool hashed_;
};
/// Of one.
std::string link_of(const std::filesystem::path& out, const std::string& campaign);

/// Days; half of the gaps between campaign days are longer than this; none of one day.
std::optional<std::int64_t> usual_interval(const std::vector<store::StoredCampaign>& campaigns);

/// The limit that applies to a followed quantity, in the unit of results.json: its own, or for the
/// mean reversal that of B, reduced by what B is larger by.
struct FollowedLimit {
  std::string quantity;  ///< that has the limit
  double limit = 0.0;
  nonio::statistics::Beyond beyond{};
};
/// None: no quantity of the axis has one, or no campaign of the series has B in addition to B_mean.
std::optional<FollowedLimit> limit_of(const AssessedMachine& machine, const FollowedSeries& series);

/// What pages and programs show of a machine. `due`: day of the next calibration by a rule, `why`
/// in words; empty: there is none, and forecasts look one usual interval ahead. A forecast for a day
/// before `today` is overdue.
/// Whether a change of a quantity of this axis is between the same campaigns.
bool is_at(const reports::TableLoaded& table, const std::string& axis,
           const reports::HistoryChange& change);

reports::MachineHistory describe(const AssessedMachine& machine, const std::filesystem::path& out,
                                 const std::string& due, const std::string& why,
                                 const std::string& today = {});

}  // namespace nonio::assessment
