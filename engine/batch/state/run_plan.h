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

/// A run that several processes, perhaps on several hosts, do in parts. It is kept in
/// OUT/.nonio/plan: `plan.json`, written last, names a folder with a list for each shard and one of
/// all other campaigns. Whoever does a part opens its files by these names and lists nothing.
struct RunPlan {
  struct List {
    std::uint64_t campaigns = 0;
    std::string sha256;  ///< of the file
  };
  std::string id;  ///< of this plan, and of its folder; another plan of the same run has another
  evaluation::RunLabel run{};
  std::string site;            ///< its folder on the host that planned
  reading::Inputs made_with;   ///< site.toml, plugins, templates, version: as for every campaign
  bool register_read = false;  ///< false: another process kept the register of numbers locked
  std::optional<std::uint64_t>
      history_known{};  ///< the run up to which the history was complete before
  std::uint64_t to_do = 0, seen = 0;
  std::vector<std::string> notes{};
  std::vector<Vanished> vanished{};
  std::vector<List> shards{};
  List rest{};
};

/// The first 64 bits of the SHA-256 of the id, modulo the number of shards: neither a change of the
/// readings nor another folder moves a campaign.
std::uint64_t shard_of(const std::string& campaign, std::uint64_t shards);

/// Writes the lists of `plan.shards.size()` shards, then plan.json; completes the plan. Campaigns
/// in the order of their ids. Those that need the register are left to the merge if that is known
/// already.
Expected<void> write_plan(const std::filesystem::path& out, RunPlan& plan,
                          const std::vector<CampaignState>& campaigns);
/// None if no run is planned; an error if the plan cannot be read.
Expected<std::optional<RunPlan>> find_plan(const std::filesystem::path& out);
/// An error if there is none.
Expected<RunPlan> read_plan(const std::filesystem::path& out);
/// plan.json first: without it there is no plan.
Expected<void> remove_plan(const std::filesystem::path& out);
/// An error names what differs here from where the run was planned.
Expected<void> check_made_with(const RunPlan& plan, const reading::Context& context);

/// A campaign of a list. Other campaigns that have its readings are named by their ids.
struct Listed {
  CampaignState campaign;
  std::vector<std::pair<std::uint64_t, std::string>> twins{};
};
Expected<std::vector<Listed>> read_shard_list(const std::filesystem::path& out, const RunPlan& plan,
                                              std::uint64_t shard);
/// What no shard does: unchanged, refused, left to the merge.
Expected<std::vector<Listed>> read_rest(const std::filesystem::path& out, const RunPlan& plan);

/// What became of a campaign in its shard.
struct ShardResult {
  std::string campaign;
  evaluation::Status status = evaluation::Status::none;  ///< none: it is left to the merge
  bool stored = true;   ///< false: it failed, and its failure could not be written either
  bool packed = false;  ///< its results are in the pack of the shard
  std::vector<Error> errors{};
};
struct ShardRecord {
  std::vector<ShardResult> results;
  std::optional<storage::PackFile> pack{};
};
/// Written last by whoever does the shard; two who do it write the same.
Expected<void> write_shard_record(const std::filesystem::path& out, const RunPlan& plan,
                                  std::uint64_t shard, const ShardRecord& record);
/// None if the shard has not reported.
Expected<std::optional<ShardRecord>> read_shard_record(const std::filesystem::path& out,
                                                       const RunPlan& plan, std::uint64_t shard);
/// How many shards have reported.
std::uint64_t reported(const std::filesystem::path& out, const RunPlan& plan);

}  // namespace nonio::batch
