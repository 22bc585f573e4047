// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batch/state/run_plan.h"
#include "batch/state/run_result.h"
#include "platform/storage/scratch_folder.h"

/// A shard that evaluates its campaigns in a folder of its host and hands over their results as one
/// file, a pack.
namespace nonio::batch {

/// Returns the record of the shard if its pack is stored and undamaged, so that the shard need not
/// be done again; otherwise returns none.
std::optional<ShardRecord> reported_pack(const std::filesystem::path& out, const RunPlan& plan,
                                         std::uint64_t shard);

/// A temporary output folder on this host that contains the last results of the campaigns to be
/// evaluated by the shard.
class PackedShard {
 public:
  static Expected<PackedShard> begin(const RunOptions& options,
                                     const std::vector<CampaignState>& campaigns);
  const std::filesystem::path& out() const { return folder_->path(); }
  /// Writes the results of this run into a pack and moves it to the shared output folder. Marks the
  /// packed campaigns in `record`. An error names a campaign that is not stored.
  Expected<void> hand_over(const RunOptions& options, const RunPlan& plan,
                           ShardRecord& record) const;

 private:
  explicit PackedShard(std::unique_ptr<storage::ScratchFolder> folder)
      : folder_(std::move(folder)) {}
  std::unique_ptr<storage::ScratchFolder> folder_;
};

/// Accepts the packs of these shards as the results of their campaigns. Results of earlier runs in
/// the folders of the same campaigns are removed; those of this run are kept.
Expected<void> accept_packs(const std::filesystem::path& out, const RunPlan& plan,
                            const std::vector<const ShardRecord*>& shards);
/// Accepts the packs of a cancelled plan as results, so that the next run continues from them.
/// Damaged packs are skipped.
Expected<void> keep_packs(const std::filesystem::path& out);

}  // namespace nonio::batch
