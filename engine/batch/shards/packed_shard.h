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

/// A shard that does its campaigns in a folder of its host and hands their results over as one file.
namespace nonio::batch {

/// What the shard has reported, if its pack is there as it was handed over: there is nothing to do then.
std::optional<ShardRecord> reported_pack(const std::filesystem::path& out, const RunPlan& plan,
                                         std::uint64_t shard);

/// An output folder of this host alone, with the last results of these campaigns; a temporary.
class PackedShard {
 public:
  static Expected<PackedShard> begin(const RunOptions& options,
                                     const std::vector<CampaignState>& campaigns);
  const std::filesystem::path& out() const { return folder_->path(); }
  /// The results of this run into a pack, and that to where all hosts see it. Marks them in `record`; an error
  /// names a campaign that is not stored.
  Expected<void> hand_over(const RunOptions& options, const RunPlan& plan,
                           ShardRecord& record) const;

 private:
  explicit PackedShard(std::unique_ptr<storage::ScratchFolder> folder)
      : folder_(std::move(folder)) {}
  std::unique_ptr<storage::ScratchFolder> folder_;
};

/// The packs of these shards count from now on. Results in folders of the same campaigns, of earlier runs, are
/// removed; those of this run stay, and count.
Expected<void> accept_packs(const std::filesystem::path& out, const RunPlan& plan,
                            const std::vector<const ShardRecord*>& shards);
/// Of a plan that is given up: what its shards have handed over counts. Packs that are damaged are left out.
Expected<void> keep_packs(const std::filesystem::path& out);

}  // namespace nonio::batch
