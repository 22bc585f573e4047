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

/// What every campaign of a run shares.
struct Context {
  std::string version;
  config::SiteFile site;
  std::string site_sha256;            ///< of site.toml; of nothing if there is none
  config::MachineRecords machines{};  ///< of the site
  const loader::Plugins* plugins = nullptr;
  std::string plugins_sha256;  ///< empty where no results are recorded
  std::string today{};         ///< YYYY-MM-DD; empty where no day is too late
  Templates templates;
  std::string templates_sha256;
  std::string templates_json{};  ///< see `read_templates`; travels in what is signed
  bool every_cause = false;      ///< of the library is an effect; else where a model names one
};

/// What a campaign's results depend on, in the order in which a change is reported.
using Inputs = std::vector<std::pair<std::string, std::string>>;  // name, SHA-256

/// How a measurement file is called in `Inputs`.
std::string input_name(const std::string& file);

/// How it is called in `Inputs` that another campaign has the same file; its value is that
/// campaign's id.
std::string shared_name(const std::string& file);

/// The parts of `Inputs` that all campaigns share.
Inputs shared_inputs(const Context& context);

/// Called with the name of what is called next, for the case that it does not return.
using Stage = std::function<void(const std::string&)>;

/// Files of readings (the first 64 bits of their SHA-256) that another campaign has too, and its
/// id.
using Twins = std::vector<std::pair<std::uint64_t, std::string>>;

}  // namespace nonio::reading
