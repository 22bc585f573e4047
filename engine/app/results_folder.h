// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common.h"

namespace nonio::app {

/// What a folder that a user names holds, by the files in it.
enum class Holds { campaign, results, run, nothing };
Holds what_holds(const std::filesystem::path& folder);

/// OUT/ID, or where a pack has its results.
std::filesystem::path results_at(const std::filesystem::path& folder);
/// "results.json, summary.json or campaign.toml" was wanted in a folder: the complaint.
std::string holds_nothing(const std::filesystem::path& folder);

/// The id that a run would give to a campaign, also if other parts of the manifest have errors.
std::string id_of_campaign(const std::filesystem::path& folder);

}  // namespace nonio::app
