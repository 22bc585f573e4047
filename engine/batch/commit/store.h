// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "batch/state/run_result.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/disk.h"

namespace nonio::batch {

/// Contents of run.json that are not part of the results.
struct StoreNote {
  std::string folder;
  evaluation::RunLabel run{};
  std::string reason;
  bool retry = false;
};

/// Writes the results under temporary names, which `commit` replaces by the final names.
Expected<void> stage(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note);

struct Staged {
  std::string id;
  /// Number of lost writes that the disk had reported before the first file was written.
  std::uint32_t losses = 0;
};

/// Gives staged files their final names after they were read back from the disk, with one flush per
/// step for all campaigns. The record is renamed last, so that it always lists files that belong
/// together. Good results that a temporary failure replaces are kept in `last-good`. Returns one
/// result per campaign.
std::vector<Expected<void>> commit(const std::filesystem::path& out,
                                   const std::vector<Staged>& campaigns, std::uint64_t run,
                                   const storage::Disk& disk);

Expected<void> store(const std::filesystem::path& out, const evaluation::Evaluated& evaluated,
                     const reading::Context& context, const StoreNote& note,
                     const storage::Disk& disk);

/// Removes temporary files of interrupted runs from the folder. An error names a file that remains.
Expected<void> tidy(const std::filesystem::path& folder);

/// Removes temporary files of an interrupted run from the output folder and its folder .nonio.
void tidy_root(const std::filesystem::path& out);

/// Removes temporary files from the output folder and the results folders of campaigns that this
/// run evaluated; if `resumed`, from all results folders. An error if a stop was requested, a
/// folder cannot be read or a file cannot be removed.
Expected<void> tidy_all(const RunResult& run, const std::filesystem::path& out, bool resumed);

}  // namespace nonio::batch
