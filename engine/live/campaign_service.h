// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "live/launcher.h"
#include "live/server.h"
#include "live/service.h"

namespace nonio::live {

/// A service that has its processes, and no thread yet.
class Starting : public Service {
 public:
  /// Threads may be made from now on.
  virtual Expected<void> begin() = 0;
};

/// Folders with a campaign.toml below a site, relative to it, in order.
std::vector<std::string> campaigns_in(const std::filesystem::path& site);

/// What a page begins with, in the language of the site.
struct Shells {
  std::string campaign, site;
  Sentences sentences;
  double seconds = 0.0;  ///< that a verb may take: site.toml, [limits]
};

/// Of a site: its worklist, and the workbench of each of its campaigns.
std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, Shells shells);

/// Of a campaign, or of a site if the folder has no campaign.toml.
Expected<std::unique_ptr<Starting>> service_of(const LiveWish& wish);

}  // namespace nonio::live
