// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "live/launcher.h"
#include "live/server.h"
#include "live/service.h"

namespace nonio::live {

/// A service whose processes are started, but no threads yet.
class Starting : public Service {
 public:
  /// Starts the threads of the service.
  virtual Expected<void> begin() = 0;
};

/// Returns the folders with a campaign.toml, the site itself or up to four levels below it,
/// relative to the site and sorted.
std::vector<std::string> campaigns_in(const std::filesystem::path& site);

/// HTML of the pages and the sentences that they show, in the language of the site.
struct Shells {
  std::string campaign, site;
  Sentences sentences;
  double seconds = 0.0;  ///< time limit of a command in s, from site.toml, [limits]
};

/// Makes the service of a site: its worklist, and the workbench of each of its campaigns.
std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, Shells shells);

/// Makes the service of a campaign, or of a site if the folder has no campaign.toml.
Expected<std::unique_ptr<Starting>> service_of(const LiveWish& wish);

}  // namespace nonio::live
