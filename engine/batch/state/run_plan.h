// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "platform/storage/packed_results.h"

namespace nonio::batch {

/// A run that several processes, possibly on several hosts, do in shards. It is stored in
/// OUT/.nonio/plan: `plan.json`, written last, names a folder with one list for each shard and one
/// of all other campaigns. A shard opens files only by these names and lists no folders.
struct RunPlan {
  struct List {
    std::uint64_t campaigns = 0;
    std::string sha256;  ///< SHA-256 of the file with the list
  };
  std::string id;  ///< id of the plan and of its folder; a second plan of the same run has another
                   ///< id
  evaluation::RunLabel run{};
  std::string site;            ///< folder of the site on the host that made the plan
  reading::Inputs made_with;   ///< digests of site.toml, plugins, templates and version
  bool register_read = false;  ///< whether the register was read; false: another process kept it
                               ///< locked
  std::optional<std::uint64_t>
      history_known{};  ///< number of the run up to which the history was complete when the plan
                        ///< was made; empty: not known
  std::uint64_t to_do = 0, seen = 0;
  std::vector<std::string> notes{};
  std::vector<Vanished> vanished{};
  std::vector<List> shards{};
  List rest{};
};

/// Returns the shard of a campaign: the first 64 bits of the SHA-256 of its id, modulo the number
/// of shards. Neither new readings nor another folder change the shard of a campaign.
std::uint64_t shard_of(const std::string& campaign, std::uint64_t shards);

/// Writes the lists of `plan.shards.size()` shards, then plan.json, and completes the plan.
/// Campaigns are in the order of their ids. Campaigns that are known to need the register are left
/// to the merge.
Expected<void> write_plan(const std::filesystem::path& out, RunPlan& plan,
                          const std::vector<CampaignState>& campaigns);
/// Returns the plan, none if no run is planned; an error if the plan cannot be read.
Expected<std::optional<RunPlan>> find_plan(const std::filesystem::path& out);
/// Returns the plan; an error if no run is planned or the plan cannot be read.
Expected<RunPlan> read_plan(const std::filesystem::path& out);
/// Removes plan.json first, because without it the plan does not exist, then the lists.
Expected<void> remove_plan(const std::filesystem::path& out);
/// Checks that site.toml, plugins, templates and version are those of the plan. An error names the
/// differences.
Expected<void> check_made_with(const RunPlan& plan, const reading::Context& context);

/// A campaign of a list, and the ids of other campaigns with the same files of readings.
struct Listed {
  CampaignState campaign;
  std::vector<std::pair<std::uint64_t, std::string>> twins{};
};
Expected<std::vector<Listed>> read_shard_list(const std::filesystem::path& out, const RunPlan& plan,
                                              std::uint64_t shard);
/// Returns the campaigns that belong to no shard because they are unchanged, refused, or left to
/// the merge.
Expected<std::vector<Listed>> read_rest(const std::filesystem::path& out, const RunPlan& plan);

/// Outcome of a campaign in its shard.
struct ShardResult {
  std::string campaign;
  evaluation::Status status = evaluation::Status::none;  ///< status of the results; none: the
                                                         ///< campaign is left to the merge
  bool stored = true;   ///< false: the campaign failed, and the failure could not be stored
  bool packed = false;  ///< whether the results are in the pack of the shard
  std::vector<Error> errors{};
};
struct ShardRecord {
  std::vector<ShardResult> results;
  std::optional<storage::PackFile> pack{};
};
/// Writes the record of a shard, as the last step. Two processes that do the same shard write the
/// same bytes.
Expected<void> write_shard_record(const std::filesystem::path& out, const RunPlan& plan,
                                  std::uint64_t shard, const ShardRecord& record);
/// Returns the record of a shard, none if it has not reported; an error if the record is damaged or
/// belongs to another plan.
Expected<std::optional<ShardRecord>> read_shard_record(const std::filesystem::path& out,
                                                       const RunPlan& plan, std::uint64_t shard);
/// Returns how many shards have reported.
std::uint64_t reported(const std::filesystem::path& out, const RunPlan& plan);

}  // namespace nonio::batch
