// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "live/server.h"
#include "live/service.h"
#include "live/tool.h"

namespace nonio::live {

/// A service whose processes are running, but not its threads.
class Starting : public Service {
 public:
  /// Starts the threads of the service.
  virtual Expected<void> begin() = 0;
};

/// Returns the folders with a campaign.toml, at most five levels deep, relative to the site and
/// sorted.
std::vector<std::string> campaigns_in(const std::filesystem::path& site);

/// HTML and sentences of the pages in the language of the site.
struct Shells {
  std::string campaign, site;
  Sentences sentences;
  double seconds = 0.0;  ///< time limit of a command, s
};

std::unique_ptr<Starting> site_service(const LiveWish& wish, Launcher launcher, Shells shells);

Expected<std::unique_ptr<Starting>> service_of(const LiveWish& wish);

}  // namespace nonio::live
