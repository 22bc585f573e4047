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

/// Everything that a run or an approval works with: site, key, templates, plugins. The object must
/// not be moved, because `host` refers to `context`.
struct SetUp {
  reading::Context context;
  std::optional<certificates::Signer> signer;
  loader::Plugins plugins;  ///< declarations of the plugins; this process does not contain their
                            ///< code
  std::optional<PluginHost> host;
  SiteParts parts;
  std::vector<std::string> notes;  ///< notes for the summary of the run
  std::string unstamped;           ///< note for the summary that no time-stamp server is
                                   ///< configured; it is the same in every run
  std::string no_key;              ///< why nothing can be signed; empty: signing works
};

/// Reads the site and starts the plugin host. An error states all mistakes of the site file. If
/// this process may have to sign (whole run or merge, no dry run), the process that holds the key
/// is started before any plugin is loaded.
Expected<std::unique_ptr<SetUp>> set_up(const RunOptions& options);

}  // namespace nonio::batch
