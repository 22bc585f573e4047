// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/machines.h"
#include "campaign/config/manifest.h"
#include "campaign/config/template_files.h"
#include "campaign/loader/plugins.h"

namespace nonio::reading {

/// Data that all campaigns of a run share.
struct Context {
  std::string version;
  config::SiteFile site;
  std::string site_sha256;  ///< digest of site.toml, or of an empty text
  config::MachineRecords machines{};
  const loader::Plugins* plugins = nullptr;
  std::string plugins_sha256;  ///< empty if no results are recorded
  std::string today{};         ///< YYYY-MM-DD; if empty, no date is too late
  Templates templates;
  config::TemplateTexts template_texts{};  ///< empty if no results are recorded
  /// Whether causes become effects even if no model names a cause.
  bool every_cause = false;
};

/// Data on which results depend, in the order in which changes are reported.
using Inputs = std::vector<std::pair<std::string, std::string>>;  // name and SHA-256 of each input

std::string input_name(const std::string& file);

/// Returns the name under which `Inputs` records the id of another campaign with the same file.
std::string shared_name(const std::string& file);

Inputs shared_inputs(const Context& context);

/// Called with the name of each step before it begins, to report a step that does not return.
using Stage = std::function<void(const std::string&)>;

/// First 64 bits of the SHA-256 of each file that another campaign contains, and id of that
/// campaign.
using Twins = std::vector<std::pair<std::uint64_t, std::string>>;

}  // namespace nonio::reading
