// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/disk.h"

namespace nonio::batch {

/// What the record of a campaign states in addition to its results.
struct StoreNote {
  std::string folder;
  evaluation::RunLabel run{};
  std::string reason;
  bool retry = false;
};

/// Writes a campaign's files into its output folder under temporary names; `commit` gives them
/// theirs.
Expected<void> stage(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note);

/// A campaign whose files are staged.
struct Staged {
  std::string id;
  std::uint32_t losses = 0;  ///< of the disk, before its first file was written
};

/// Makes the staged files of these campaigns their results, durably: one flush of the disk serves
/// all of them. They are read back from the disk first. Then the old record is put aside, and the
/// new one gets its name last: whenever a record is there, all the files it lists belong together.
/// Results that a failure replaces which may pass go into the folder `last-good`. One entry for
/// each campaign.
std::vector<Expected<void>> commit(const std::filesystem::path& out,
                                   const std::vector<Staged>& campaigns, std::uint64_t run,
                                   const storage::Disk& disk);

/// Both, for one campaign.
Expected<void> store(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note,
                     const storage::Disk& disk);

/// Removes what is left in a campaign's output folder of results that were not stored, or of
/// storing them. An error names what cannot be removed.
Expected<void> tidy(const std::filesystem::path& folder);

}  // namespace nonio::batch
