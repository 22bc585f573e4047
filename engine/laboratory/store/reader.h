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

/// A campaign as its last evaluation knows it.
struct StoredCampaign {
  std::string id, day, customer, purpose, status;
  InstrumentAsStated instrument;
  std::int64_t evaluation = 0;
  std::uint64_t run = 0;  ///< in which that evaluation came
  std::string number{};   ///< of its last certificate
  std::string place{}, control{};
};

/// A number of a campaign: of what is followed, or a result with a tolerance or U.
struct StoredResult {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity;
  std::string source{};  ///< "followed", or the analysis
  std::string unit, state, decision, conditions;
  bool followed = false;
  double value = 0.0;
  std::optional<double> u_repeat{}, expanded{}, k{}, tolerance{};
  std::vector<CommonPart> common{};
  /// Index into StoredMachine::other_targets, and the place of the number in it; none if the number
  /// does not depend on targets.
  std::optional<std::size_t> targets{};
  std::size_t place = 0;
};

/// A limit with which no value of the campaign could be compared.
struct LimitWithoutValue {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

/// What a measurement of an axis states of the control's tables.
struct StoredTables {
  std::size_t campaign = 0;  ///< index into StoredMachine::campaigns
  std::string measurement, axis;
  std::string json{};  ///< the member of `control_tables` of results.json
};


/// All that the store has of one machine, without failed campaigns, which measured nothing.
struct StoredMachine {
  std::vector<StoredCampaign> campaigns;  ///< by day, then by id
  std::vector<StoredResult> results;      ///< in the order of their campaigns
  std::vector<StoredResult> predicted{};  ///< by tables: the same order
  /// JSON, member `other_targets` of results.json.
  std::vector<std::string> other_targets{};
  /// Severity by finding of the last evaluation of each campaign.
  std::vector<std::map<std::string, std::string>> findings;
  /// Of the last evaluation of each campaign: findings of tables and certificates with severity
  /// warning, and refusals of analyses.
  std::vector<std::vector<FindingRow>> asked{};
  std::vector<LimitWithoutValue> without_value{};
  std::vector<StoredTables> tables{};  ///< in the order of their campaigns
  struct Later {
    std::string campaign, day;
  };
  std::vector<Later> later{};  ///< campaigns dated after the day that was requested: not here
};

/// A machine, with aliases joined.
struct MachineState {
  NamedMachine machine;
  std::uint64_t run = 0;            ///< of the last evaluation that counts
  std::set<std::string> serials{};  ///< that its campaigns state
};

/// An evaluation, whether another supersedes it or not.
struct StoredEvaluation {
  std::string machine;  ///< aliases joined; empty: of none
  std::string campaign, sha256, day;
  std::uint64_t run = 0;
  bool counts = true;  ///< no other supersedes it
};

/// A campaign's last evaluation.
struct CountedCampaign {
  std::string machine;  ///< aliases joined; empty: of none
  std::string campaign, day, sha256;
};

/// Entries of people, as the store has them.
struct StoredLogs {
  std::vector<config::Event> events;
  std::vector<config::Acknowledgement> acknowledged;
  std::vector<config::Forgotten> forgotten;
  std::map<std::string, std::string> aliases;  ///< machine by alias
  std::map<std::string, int> due;              ///< months by machine; "": of all others
  std::set<std::string> recorded{};            ///< machines that have records with events
};

/// Reads a store; evaluations that another supersedes are never seen.
class StoreReader {
 public:
  /// An error if there is no store, or one of another version.
  static Expected<StoreReader> open(const std::filesystem::path& out);

  /// With aliases joined, by name; machines without a name are left out.
  Expected<std::vector<MachineState>> machines();
  /// `until`: what is dated after this day is not measured yet.
  Expected<StoredMachine> machine(const std::string& name, const std::string& until = "9999-12-31");
  /// A single campaign: which campaigns without a stated machine belong together is not known.
  Expected<StoredMachine> campaign(const std::string& id, const std::string& until = "9999-12-31");
  Expected<StoredLogs> logs();
  /// The machine of each campaign, aliases joined.
  Expected<std::map<std::string, std::string>> machine_of_campaigns();
  /// In their order: the same list, the same results.
  Expected<std::vector<StoredEvaluation>> evaluations();
  /// Of each campaign the one that counts, without those that failed; by machine, day and id.
  Expected<std::vector<CountedCampaign>> counted_campaigns();
  /// Numbers of each campaign and what they replace, as one text.
  Expected<std::map<std::string, std::string>> certificates();
  /// How many different quantities of axes each run from this one on has evaluated.
  Expected<std::map<std::uint64_t, std::uint64_t>> followed_since(std::uint64_t run);

 private:
  enum class Of { machine, campaign };
  Expected<StoredMachine> stored(Of of, const std::string& name, const std::string& until);
  explicit StoreReader(storage::Database database) : database_(std::move(database)) {}
  storage::Database database_;
};

}  // namespace nonio::store
