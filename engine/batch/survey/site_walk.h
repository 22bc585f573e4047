// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Paths are sorted and relative to the site, which itself is ".".
struct SiteWalk {
  struct Unlisted {
    std::string folder, why;
  };
  std::vector<std::string> campaigns;  ///< folders with a manifest
  std::vector<Unlisted> unlisted;      ///< folders that could not be listed
  std::vector<std::string> notes;      ///< messages about skipped links and wrong file names
};

/// Finds the folders of all campaigns in a site, except in hidden folders and in the output folder.
/// Links are not followed, because a campaign must be stored in the site. Runs in a child process;
/// a folder that does not respond within `seconds` (s) is added to `unlisted`. An error if the site
/// cannot be listed. If `stopped` returns true, the result is incomplete.
Expected<SiteWalk> walk_site(const std::filesystem::path& site, const std::filesystem::path& out,
                             double seconds, bool (*stopped)());

}  // namespace nonio::batch
