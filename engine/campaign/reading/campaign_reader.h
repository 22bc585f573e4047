// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/causes.h"
#include "campaign/reading/context.h"

namespace nonio::reading {

/// Remark about a former key. Documents omit it, because the remark concerns the file.
inline constexpr const char* former_key_note = "manifest.former-key";

struct ReadCampaign {
  std::optional<config::Manifest> manifest;  ///< nullopt after errors; then no measurement is read
  std::optional<config::MachineRecord> machine{};  ///< nullopt if the site has no valid record
  /// Files of the tables that were active during the measurement, by axis.
  std::map<std::string, std::vector<Artifact>> active_tables{};
  /// Files of the states in `machine`, by ControlState::files.
  std::map<std::string, std::vector<Artifact>> state_files{};
  /// One entry per measurement, which is empty if the file cannot be read.
  std::vector<Observations> observations;
  std::vector<Effect> effects;
  /// Causes that the model may name are also in `effects`.
  config::Library causes = std::make_shared<std::vector<config::Cause>>();
  std::vector<Finding> doubts{};  ///< findings about implausible files
  std::vector<Remark> notes;
  std::vector<std::string> unread;  ///< measurements of a kind that no plugin reads
  std::vector<Error> errors;
  Inputs inputs;  ///< digests of files and machine record, manifest first
};

ReadCampaign read_campaign(const std::filesystem::path& folder, const Context& context,
                           const Stage& stage);

struct Workplace {
  loader::Plugins plugins;
  Context context;
  std::vector<std::string> notes;
};

/// `documents` needs all templates; others read only words and causes. Except with `terminal`,
/// causes can be named.
enum class TemplatesFor { documents, terminal, terminal_with_library };

/// Loads plugins, templates, site.toml and machine records. Returns an error for
/// `Plugins::conflicts`.
Expected<std::unique_ptr<Workplace>> open_workplace(
    const std::filesystem::path& campaign, const std::vector<std::filesystem::path>& plugin_folders,
    const std::vector<std::filesystem::path>& template_folders, const std::string& version,
    TemplatesFor what = TemplatesFor::documents);

}  // namespace nonio::reading
