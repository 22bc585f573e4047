// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/config/site_logs.h"
#include "laboratory/store/entry.h"
#include "laboratory/store/identity.h"
#include "platform/storage/database.h"

namespace nonio::store {

/// A campaign according to its last evaluation.
struct StoredCampaign {
  std::string id, day, customer, purpose, status;
  InstrumentAsStated instrument;
  std::int64_t evaluation = 0;
  std::uint64_t run = 0;
  std::string number{};  ///< number of the last certificate; empty if none was issued
  std::string place{}, control{};
  std::string evaluated{};  ///< date of the run of the evaluation
};

/// A followed quantity, a value with a limit, or another value that the history contains, such as
/// A, B, E, M and R.
struct StoredResult {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity;
  /// "followed", the analysis, or for a prediction the controller plugin.
  std::string source{};
  std::string unit, state, decision, conditions;
  bool followed = false;
  double value = 0.0;
  std::optional<double> u_repeat{}, expanded{}, k{}, tolerance{};
  std::vector<CommonPart> common{};
  /// Index into StoredMachine::other_targets, with the index `place` of the quantity. std::nullopt
  /// if the result does not depend on the choice of targets.
  std::optional<std::size_t> targets{};
  std::size_t place = 0;
};

struct LimitWithoutValue {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

struct StoredTables {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis;
  std::string json{};  ///< entry of `control_tables` in results.json
};

/// Data of one machine without failed campaigns.
struct StoredMachine {
  std::vector<StoredCampaign> campaigns;  ///< sorted by date and id
  std::vector<StoredResult> results;      ///< sorted by campaign
  std::vector<StoredResult> predicted{};  ///< predicted by tables, sorted by campaign
  /// Members `other_targets` of results.json.
  std::vector<std::string> other_targets{};
  /// Highest severity by id of the finding, for each campaign.
  std::vector<std::map<std::string, std::string>> findings;
  /// Findings of severity warning that withhold a table, a certificate or a result or report an
  /// invalid calibration, for each campaign.
  std::vector<std::vector<FindingRow>> asked{};
  std::vector<LimitWithoutValue> without_value{};
  std::vector<StoredTables> tables{};  ///< sorted by campaign
  struct Later {
    std::string campaign, day;
  };
  std::vector<Later> later{};  ///< campaigns after the requested date, which `campaigns` excludes
};

/// A machine; data of campaigns that state one of its aliases are included.
struct MachineState {
  NamedMachine machine;
  std::uint64_t run = 0;  ///< run of its last evaluation in force
  std::set<std::string> serials{};
};

struct StoredEvaluation {
  /// Name of the machine, even if the campaign states an alias; empty without a machine.
  std::string machine;
  std::string campaign, sha256, day;
  std::uint64_t run = 0;
  bool counts = true;  ///< whether the evaluation is not superseded
};

/// The last evaluation of a campaign.
struct CountedCampaign {
  /// Name of the machine, even if the campaign states an alias; empty without a machine.
  std::string machine;
  std::string campaign, day, sha256;
};

/// Logs (events, acknowledgements, campaigns removed on purpose), aliases and calibration
/// intervals.
struct StoredLogs {
  std::vector<config::Event> events;
  std::vector<config::Acknowledgement> acknowledged;
  std::vector<config::Forgotten> forgotten;
  std::map<std::string, std::string> aliases;  ///< name by alias
  /// Calibration interval in months by machine; "" for all others.
  std::map<std::string, int> due;
  std::set<std::string> recorded{};  ///< machines with events in their records
};

/// Reads a store. Superseded evaluations are skipped unless stated otherwise.
class StoreReader {
 public:
  /// An error if there is no store of this version.
  static Expected<StoreReader> open(const std::filesystem::path& out);

  /// Sorted by name. Campaigns that state an alias belong to its machine; those without a machine
  /// are omitted.
  Expected<std::vector<MachineState>> machines();
  /// Campaigns after the date `until` are only listed in `later`.
  Expected<StoredMachine> machine(const std::string& name, const std::string& until = "9999-12-31");
  Expected<StoredMachine> campaign(const std::string& id, const std::string& until = "9999-12-31");
  Expected<StoredLogs> logs();
  /// Returns the name of the machine, even if the campaign states an alias, by id of the campaign.
  Expected<std::map<std::string, std::string>> machine_of_campaigns();
  /// Includes superseded evaluations, in the order of the store.
  Expected<std::vector<StoredEvaluation>> evaluations();
  /// Returns the campaigns that have not failed, by machine, date and id.
  Expected<std::vector<CountedCampaign>> counted_campaigns();
  /// Returns the numbers of certificates, and of those that they replace, as one text by campaign.
  Expected<std::map<std::string, std::string>> certificates();
  /// Returns the number of different followed quantities of all machines by run, from `run` on.
  Expected<std::map<std::uint64_t, std::uint64_t>> followed_since(std::uint64_t run);

 private:
  enum class Of { machine, campaign };
  Expected<StoredMachine> stored(Of of, const std::string& name, const std::string& until);
  explicit StoreReader(storage::Database database) : database_(std::move(database)) {}
  storage::Database database_;
};

}  // namespace nonio::store
