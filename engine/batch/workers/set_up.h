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

/// What a run, or a release, works with: site, key, templates, plugins. Stays where it is.
struct SetUp {
  reading::Context context;
  std::optional<certificates::Signer> signer;
  loader::Plugins plugins;  ///< their declarations: this process has none of their code
  std::optional<PluginHost> host;
  SiteParts parts;
  std::vector<std::string> notes;  ///< for the reader of the summary
  std::string unstamped;           ///< for the summary alone: it is the same in every run
  std::string no_key;              ///< why nothing can be signed; empty: it can
};

/// An error states all mistakes of the site. The process that holds the key is made before any
/// plugin is loaded.
Expected<std::unique_ptr<SetUp>> set_up(const RunOptions& options);

}  // namespace nonio::batch
