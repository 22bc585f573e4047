// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common.h"

namespace nonio::app {

/// Kind of a folder, determined by the files in it.
enum class Holds { campaign, results, run, nothing };
Holds what_holds(const std::filesystem::path& folder);

/// Returns the path inside the pack that contains the results OUT/ID, if the folder itself contains
/// none; otherwise returns the folder unchanged.
std::filesystem::path results_at(const std::filesystem::path& folder);
/// Returns the error message for a folder that does not exist, or contains neither results.json,
/// summary.json nor campaign.toml.
std::string holds_nothing(const std::filesystem::path& folder);

/// Returns the id that a run would give to a campaign, even if other parts of the manifest have
/// errors.
std::string id_of_campaign(const std::filesystem::path& folder);

}  // namespace nonio::app
