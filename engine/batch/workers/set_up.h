// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/survey/site_parts.h"
#include "batch/workers/plugin_host.h"
#include "certificates/signer.h"

namespace nonio::batch {

/// Must not be moved, because `host` refers to `context`.
struct SetUp {
  reading::Context context;
  std::optional<certificates::Signer> signer;
  loader::Plugins plugins;  ///< declarations without the code of the plugins
  std::optional<PluginHost> host;
  SiteParts parts;
  std::vector<std::string> notes;
  /// Note that no time-stamp server is configured; separate, because it is the same in every run.
  std::string unstamped;
  std::string no_key;  ///< reason why nothing can be signed
};

/// Reads the site and starts the plugin host. An error contains all mistakes of site.toml. In a
/// whole run or a merge, the process with the key is started before any plugin is loaded.
Expected<std::unique_ptr<SetUp>> set_up(const RunOptions& options);

}  // namespace nonio::batch
