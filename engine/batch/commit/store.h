// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/disk.h"

namespace nonio::batch {

/// Properties of an evaluation that its record states in addition to the results.
struct StoreNote {
  std::string folder;
  evaluation::RunLabel run{};
  std::string reason;
  bool retry = false;
};

/// Writes a campaign's files into its output folder under temporary names; `commit` renames them.
Expected<void> stage(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note);

/// A campaign whose files were written by `stage`.
struct Staged {
  std::string id;
  std::uint32_t losses = 0;  ///< number of write losses that the disk had reported before the first
                             ///< file of the campaign was written
};

/// Makes the staged files the results of their campaigns. Each step is made durable by one flush of
/// the disk for all campaigns. The files are read back from the disk first. Then the old record is
/// renamed, and the new record gets its name last, so that a record always lists files that belong
/// together. Results that are replaced by a temporary failure are kept in the folder `last-good`.
/// Returns one entry for each campaign.
std::vector<Expected<void>> commit(const std::filesystem::path& out,
                                   const std::vector<Staged>& campaigns, std::uint64_t run,
                                   const storage::Disk& disk);

/// Calls `stage` and `commit` for one campaign.
Expected<void> store(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note,
                     const storage::Disk& disk);

/// Removes leftovers of unfinished storing from a campaign's output folder. An error names a file
/// that cannot be removed.
Expected<void> tidy(const std::filesystem::path& folder);

}  // namespace nonio::batch
