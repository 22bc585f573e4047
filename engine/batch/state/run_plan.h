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

/// A run that several processes, possibly on several hosts, evaluate in shards. OUT/.nonio/plan
/// contains a folder with one list per shard and one of the other campaigns; plan.json, written
/// last, names the folder. A shard lists no folders, because shared file systems may show new files
/// late.
struct RunPlan {
  struct List {
    std::uint64_t campaigns = 0;
    std::string sha256;  ///< of the file with the list
  };
  std::string id;
  evaluation::RunLabel run{};
  std::string site;            ///< path on the host that made the plan
  reading::Inputs made_with;   ///< digests of site.toml, plugins, templates and version
  bool register_read = false;  ///< false if another process had locked the register
  std::optional<std::uint64_t>
      history_known{};  ///< last run that the history contained completely, if known
  std::uint64_t to_do = 0, seen = 0;
  std::vector<std::string> notes{};
  std::vector<Vanished> vanished{};
  std::vector<List> shards{};
  List rest{};
};

/// Returns the first 64 bits of the SHA-256 of the id modulo `shards`, so that new readings or
/// another folder do not change the shard.
std::uint64_t shard_of(const std::string& campaign, std::uint64_t shards);

/// Writes the lists of `plan.shards.size()` shards, then plan.json, and sets the other members of
/// `plan`. `campaigns` must be sorted by id. Campaigns that need the register are left to the
/// merge.
Expected<void> write_plan(const std::filesystem::path& out, RunPlan& plan,
                          const std::vector<CampaignState>& campaigns);
/// Returns std::nullopt if no run is planned. An error if the plan cannot be read.
Expected<std::optional<RunPlan>> find_plan(const std::filesystem::path& out);
/// An error if no run is planned or the plan cannot be read.
Expected<RunPlan> read_plan(const std::filesystem::path& out);
/// Removes plan.json before the lists, because the plan exists as long as plan.json.
Expected<void> remove_plan(const std::filesystem::path& out);
/// An error names the differences of site.toml, plugins, templates and version from the plan.
Expected<void> check_made_with(const RunPlan& plan, const reading::Context& context);

/// `twins` are first 64 bits of the SHA-256 of a file of readings and id of another campaign with
/// this file.
struct Listed {
  CampaignState campaign;
  std::vector<std::pair<std::uint64_t, std::string>> twins{};
};
Expected<std::vector<Listed>> read_shard_list(const std::filesystem::path& out, const RunPlan& plan,
                                              std::uint64_t shard);
/// Returns the campaigns without a shard: unchanged, rejected, or left to the merge.
Expected<std::vector<Listed>> read_rest(const std::filesystem::path& out, const RunPlan& plan);

struct ShardResult {
  std::string campaign;
  evaluation::Status status = evaluation::Status::none;  ///< `none` if left to the merge
  bool stored = true;   ///< false for a failure that could not be stored
  bool packed = false;  ///< whether the pack contains the results
  std::vector<Error> errors{};
};
struct ShardRecord {
  std::vector<ShardResult> results;
  std::optional<storage::PackFile> pack{};
};
/// Writes the record of a shard as its last step. Several processes of one shard write the same
/// bytes.
Expected<void> write_shard_record(const std::filesystem::path& out, const RunPlan& plan,
                                  std::uint64_t shard, const ShardRecord& record);
/// Returns std::nullopt if the shard has not reported. An error if the record is damaged or of
/// another plan.
Expected<std::optional<ShardRecord>> read_shard_record(const std::filesystem::path& out,
                                                       const RunPlan& plan, std::uint64_t shard);
/// Returns the number of shards with a record.
std::uint64_t reported(const std::filesystem::path& out, const RunPlan& plan);

}  // namespace nonio::batch
