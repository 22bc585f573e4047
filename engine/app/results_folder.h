// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common.h"

namespace nonio::app {

enum class Holds { campaign, results, run, nothing };
Holds what_holds(const std::filesystem::path& folder);

/// Returns the path in the pack if the results of the folder OUT/ID are packed, otherwise `folder`.
std::filesystem::path results_at(const std::filesystem::path& folder);
/// Returns the error message for a folder without campaign.toml, results.json and summary.json.
std::string holds_nothing(const std::filesystem::path& folder);

/// Returns the id that a run gives to the campaign, even if its manifest has other errors.
std::string id_of_campaign(const std::filesystem::path& folder);

}  // namespace nonio::app
