// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/machines.h"
#include "campaign/config/manifest.h"
#include "campaign/loader/plugins.h"

namespace nonio::reading {

/// Data that all campaigns of a run share.
struct Context {
  std::string version;
  config::SiteFile site;
  std::string site_sha256;  ///< digest of site.toml; without this file, that of an empty text
  config::MachineRecords machines{};  ///< records of the machines of the site
  const loader::Plugins* plugins = nullptr;
  std::string plugins_sha256;  ///< digest of the plugins; empty if no results are recorded
  std::string today{};  ///< date of today, YYYY-MM-DD; empty: no date is regarded as too late
  Templates templates;
  std::string templates_sha256;
  /// All templates as one text (`read_templates`), attached to signed files.
  std::string templates_json{};
  /// Whether all causes of the library become effects; otherwise only if a model names a cause.
  bool every_cause = false;
};

/// Data on which a campaign's results depend, in the order in which a change is reported.
using Inputs = std::vector<std::pair<std::string, std::string>>;  // name and SHA-256 of each input

/// Returns the name of a measurement file in `Inputs`.
std::string input_name(const std::string& file);

/// Returns the name under which `Inputs` records that another campaign has the same file; the value
/// is the id of that campaign.
std::string shared_name(const std::string& file);

/// Returns the inputs that all campaigns share: the digests of site.toml, plugins and templates,
/// and the program version.
Inputs shared_inputs(const Context& context);

/// Called with the name of each step before it begins, to report it if the step does not return.
using Stage = std::function<void(const std::string&)>;

/// Files of readings that other campaigns contain too: the first 64 bits of their SHA-256, and the
/// id of the other campaign.
using Twins = std::vector<std::pair<std::uint64_t, std::string>>;

}  // namespace nonio::reading
