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

/// Puts a campaign's files into its output folder. The record is taken away first and written last:
/// whenever it is there, all the files it lists belong together.
Expected<void> store(const std::filesystem::path& out, const Evaluated& evaluated,
                     const Context& context, const StoreNote& note);

/// The findings of all analyses and outputs, each once, with their English titles.
std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates);

}  // namespace nonio::host
