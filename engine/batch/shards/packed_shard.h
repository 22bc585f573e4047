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
#include "platform/storage/files.h"

namespace nonio::batch {

/// Returns the record of the shard, which need not be evaluated again, if its pack is stored and
/// undamaged; otherwise std::nullopt.
std::optional<ShardRecord> reported_pack(const std::filesystem::path& out, const RunPlan& plan,
                                         std::uint64_t shard);

/// A shard that works in a temporary folder of its host, which contains the last results of its
/// campaigns, and delivers its results as one file, a pack.
class PackedShard {
 public:
  static Expected<PackedShard> begin(const RunOptions& options,
                                     const std::vector<CampaignState>& campaigns);
  const std::filesystem::path& out() const { return folder_->path(); }
  /// Writes the results of this run into a pack in the shared output folder and marks the packed
  /// campaigns in `record`. An error names a campaign without stored results.
  Expected<void> hand_over(const RunOptions& options, const RunPlan& plan,
                           ShardRecord& record) const;

 private:
  explicit PackedShard(std::unique_ptr<storage::ScratchFolder> folder)
      : folder_(std::move(folder)) {}
  std::unique_ptr<storage::ScratchFolder> folder_;
};

/// Accepts the packs of these shards as results. Results of earlier runs in the folders of the same
/// campaigns are removed.
Expected<void> accept_packs(const std::filesystem::path& out, const RunPlan& plan,
                            const std::vector<const ShardRecord*>& shards);
/// Accepts the undamaged packs of a canceled plan, so that the next run continues with their
/// results.
Expected<void> keep_packs(const std::filesystem::path& out);

}  // namespace nonio::batch
