// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/host/evaluate.h"
#include "nonio/host/record.h"

namespace nonio::host {

/// What the record of a campaign says beside its results.
struct StoreNote {
  std::string folder;
  std::uint64_t night = 0;
  std::string reason;
  bool retry = false;
};

/// Writes a campaign's files into its output folder under temporary names; `commit` gives them
/// theirs.
Expected<void> stage(const std::filesystem::path& out, const Evaluated& evaluated,
                     const Context& context, const StoreNote& note);

/// Makes the staged files of these campaigns their results, durably: one flush of the disk serves
/// all of them. The old record is taken away first and the new one gets its name last: whenever a
/// record is there, all the files it lists belong together. One entry for each id.
std::vector<Expected<void>> commit(const std::filesystem::path& out,
                                   const std::vector<std::string>& ids, std::uint64_t night);

/// Both, for one campaign.
Expected<void> store(const std::filesystem::path& out, const Evaluated& evaluated,
                     const Context& context, const StoreNote& note);

/// The findings of all analyses and outputs, each once, with their English titles.
std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates);

}  // namespace nonio::host
