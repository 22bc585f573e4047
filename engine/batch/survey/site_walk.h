// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// The content of a site. Paths are sorted and relative to the site, which itself is ".".
struct SiteWalk {
  struct Unlisted {
    std::string folder, why;
  };
  std::vector<std::string> campaigns;  ///< folders with a manifest
  std::vector<Unlisted> unlisted;      ///< folders that could not be listed
  std::vector<std::string> notes;      ///< messages about what is skipped: links, wrong file names
};

/// Finds the folders of all campaigns below a site. Links are not followed, because a campaign is a
/// folder inside the site; hidden folders and the output folder are left out. Runs in a child
/// process with one open descriptor. A folder that does not answer within `seconds` (s) is added to
/// `unlisted`. An error if the site itself cannot be listed. If `stopped` returns true, the result
/// is incomplete.
Expected<SiteWalk> walk_site(const std::filesystem::path& site, const std::filesystem::path& out,
                             double seconds, bool (*stopped)());

}  // namespace nonio::batch
