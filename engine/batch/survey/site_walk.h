// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// The content of a site. Paths are relative to it, in order; the site itself is ".".
struct SiteWalk {
  struct Unlisted {
    std::string folder, why;
  };
  std::vector<std::string> campaigns;  ///< folders with a manifest
  std::vector<Unlisted> unlisted;      ///< their content is not known
  std::vector<std::string> notes;      ///< what looks like a campaign and is passed over
};

/// All folders below a site. Links are not followed: a campaign is a folder inside the site. Hidden
/// folders and the output folder are left out. The walk is done in a child process with one
/// descriptor: a folder that gives no answer within `seconds` is an unlisted one. An error if the
/// site itself cannot be listed. What is returned after `stopped` became true is incomplete.
Expected<SiteWalk> walk_site(const std::filesystem::path& site, const std::filesystem::path& out,
                             double seconds, bool (*stopped)());

}  // namespace nonio::batch
