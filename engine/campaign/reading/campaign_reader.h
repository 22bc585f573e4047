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

/// Id of the remark about a key of the manifest with a former name. It concerns the file, not a
/// measurement, so documents omit it.
inline constexpr const char* former_key_note = "manifest.former-key";

/// The content of a campaign's folder: its manifest and its measurements.
struct ReadCampaign {
  std::optional<config::Manifest> manifest;  ///< none if it has errors; then no measurement is read
  std::optional<config::MachineRecord>
      machine{};  ///< record of the campaign's machine in the site; none: there is no valid record
  /// For each axis, the files of the table that was active during the measurement, if there was
  /// one.
  std::map<std::string, std::vector<Artifact>> active_tables{};
  /// Files of the states in `machine`, by ControlState::files.
  std::map<std::string, std::vector<Artifact>> state_files{};
  /// Observations of each measurement; empty if they could not be read.
  std::vector<Observations> observations;
  std::vector<Effect> effects;  ///< effects of the plugins and of the campaign
  /// The library of causes. Causes that the model may name are also in `effects`.
  config::Library causes = std::make_shared<std::vector<config::Cause>>();
  std::vector<Finding> doubts{};  ///< findings that the files themselves are implausible
  std::vector<Remark> notes;
  std::vector<std::string> unread;  ///< measurements of a kind that no plugin reads
  std::vector<Error> errors;
  Inputs inputs;  ///< digests of the campaign's files and of the machine's record, manifest first
};

ReadCampaign read_campaign(const std::filesystem::path& folder, const Context& context,
                           const Stage& stage);

/// The data for a command about one campaign: plugins, templates and site.
struct Workplace {
  loader::Plugins plugins;
  Context context;
  std::vector<std::string> notes;  ///< notes about refused plugins and former names of keys
};

/// Which templates `open_workplace` reads: all for `documents`, otherwise only the words in the
/// language of the site and the causes, because all others take a third of the time of a short
/// command. Except with `terminal`, the causes of the library become effects that can be named.
enum class TemplatesFor { documents, terminal, terminal_with_library };

/// Loads plugins and templates, and site.toml and the records of machines of the site that contains
/// the campaign (`config::site_of`). Returns an error if plugins are in conflict
/// (`Plugins::conflicts`).
Expected<std::unique_ptr<Workplace>> open_workplace(
    const std::filesystem::path& campaign, const std::vector<std::filesystem::path>& plugin_folders,
    const std::vector<std::filesystem::path>& template_folders, const std::string& version,
    TemplatesFor what = TemplatesFor::documents);

}  // namespace nonio::reading
