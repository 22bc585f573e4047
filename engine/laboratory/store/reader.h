// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
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
  std::uint64_t run = 0;  ///< run of `evaluation`
  std::string number{};   ///< number of the campaign's last certificate; empty: none
  std::string place{}, control{};
};

/// A result of a campaign: a followed quantity, a value with a limit, or one of the values of
/// analyses that the history shows, such as A, B, E, M and R.
struct StoredResult {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity;
  /// origin of the result: "followed", the name of the analysis, or for a prediction the name of
  /// the controller plugin
  std::string source{};
  std::string unit, state, decision, conditions;
  bool followed = false;
  double value = 0.0;
  std::optional<double> u_repeat{}, expanded{}, k{}, tolerance{};
  std::vector<CommonPart> common{};
  /// Index into StoredMachine::other_targets, and the index of the quantity there; none if the
  /// result does not depend on the choice of targets.
  std::optional<std::size_t> targets{};
  std::size_t place = 0;
};

/// A limit that no value of the campaign could be compared with.
struct LimitWithoutValue {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

/// The control's tables as a measurement of an axis states them.
struct StoredTables {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis;
  std::string json{};  ///< JSON: the entry of `control_tables` of results.json
};

/// Everything that the store contains about one machine, without failed campaigns.
struct StoredMachine {
  std::vector<StoredCampaign> campaigns;  ///< sorted by day, then by id
  std::vector<StoredResult> results;      ///< sorted by campaign
  std::vector<StoredResult> predicted{};  ///< results predicted by tables, sorted by campaign
  /// Members `other_targets` of results.json, each as JSON.
  std::vector<std::string> other_targets{};
  /// Highest severity by finding id, for the last evaluation of each campaign.
  std::vector<std::map<std::string, std::string>> findings;
  /// Findings with severity warning that withhold a table, a certificate or a result, or report an
  /// invalid calibration, for the last evaluation of each campaign.
  std::vector<std::vector<FindingRow>> asked{};
  std::vector<LimitWithoutValue> without_value{};
  std::vector<StoredTables> tables{};  ///< sorted by campaign
  struct Later {
    std::string campaign, day;
  };
  std::vector<Later> later{};  ///< campaigns after the requested day; they are not in `campaigns`
};

/// A machine, with its aliases joined.
struct MachineState {
  NamedMachine machine;
  std::uint64_t run = 0;            ///< run of its last evaluation in force
  std::set<std::string> serials{};  ///< serial numbers that its campaigns state
};

/// An evaluation, superseded or not.
struct StoredEvaluation {
  std::string machine;  ///< name of the machine, with aliases joined; empty: none
  std::string campaign, sha256, day;
  std::uint64_t run = 0;
  bool counts = true;  ///< whether the evaluation is in force, that is, not superseded
};

/// The last evaluation of a campaign.
struct CountedCampaign {
  std::string machine;  ///< name of the machine, with aliases joined; empty: none
  std::string campaign, day, sha256;
};

/// Entries made by people (events, acknowledgements, campaigns removed on purpose), aliases and
/// calibration intervals, as stored.
struct StoredLogs {
  std::vector<config::Event> events;
  std::vector<config::Acknowledgement> acknowledged;
  std::vector<config::Forgotten> forgotten;
  std::map<std::string, std::string> aliases;  ///< names of the machines, by alias
  std::map<std::string, int> due;              ///< calibration interval in months, by machine; "":
                                               ///< all others
  std::set<std::string> recorded{};            ///< machines that have records with events
};

/// Reads a store. Superseded evaluations are skipped unless stated otherwise.
class StoreReader {
 public:
  /// Opens the store. An error if it does not exist, or is of another version.
  static Expected<StoreReader> open(const std::filesystem::path& out);

  /// Returns the machines by name, with aliases joined; campaigns without a machine are left out.
  Expected<std::vector<MachineState>> machines();
  /// Reads one machine. `until`: campaigns after this day are listed in `later` only.
  Expected<StoredMachine> machine(const std::string& name, const std::string& until = "9999-12-31");
  /// Reads a single campaign that states no machine. It is unknown which of these campaigns belong
  /// to one machine.
  Expected<StoredMachine> campaign(const std::string& id, const std::string& until = "9999-12-31");
  Expected<StoredLogs> logs();
  /// Returns the machine of each campaign, with aliases joined.
  Expected<std::map<std::string, std::string>> machine_of_campaigns();
  /// Returns all evaluations, including superseded ones, in the order of the store.
  Expected<std::vector<StoredEvaluation>> evaluations();
  /// Returns the evaluation in force of each campaign, without failed ones; by machine, day and id.
  Expected<std::vector<CountedCampaign>> counted_campaigns();
  /// Returns, by campaign, the numbers of its certificates and of the certificates that they
  /// replace, as one text.
  Expected<std::map<std::string, std::string>> certificates();
  /// Returns, for each run from `run` on, the number of different followed quantities of axes of
  /// all machines that it evaluated.
  Expected<std::map<std::uint64_t, std::uint64_t>> followed_since(std::uint64_t run);

 private:
  enum class Of { machine, campaign };
  Expected<StoredMachine> stored(Of of, const std::string& name, const std::string& until);
  explicit StoreReader(storage::Database database) : database_(std::move(database)) {}
  storage::Database database_;
};

}  // namespace nonio::store
