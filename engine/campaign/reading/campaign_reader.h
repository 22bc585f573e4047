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

/// Id of the remark on a key of the manifest with a former name. It is of the file, not of the
/// measurement: documents omit it.
inline constexpr const char* former_key_note = "manifest.former-key";

/// One campaign folder: the content of its manifest and its measurements.
struct ReadCampaign {
  std::optional<config::Manifest> manifest;  ///< none if it cannot be read; then nothing else is
  std::optional<config::MachineRecord>
      machine{};  ///< what the site knows of the campaign's machine
  /// Of each axis: files of the table that was on while it was measured, where it was one.
  std::map<std::string, std::vector<Artifact>> active_tables{};
  /// Files of the states that `machine` has, by ControlState::files.
  std::map<std::string, std::vector<Artifact>> state_files{};
  std::vector<Observations> observations;  ///< of each measurement; empty where none could be read
  std::vector<Effect> effects;             ///< of the plugins and the campaign
  /// The library. Causes that the model may name are among the effects too.
  config::Library causes = std::make_shared<std::vector<config::Cause>>();
  std::vector<Finding> doubts{};  ///< what makes the files themselves implausible
  std::vector<Remark> notes;
  std::vector<std::string> unread;  ///< measurements of a kind that no plugin reads
  std::vector<Error> errors;
  Inputs inputs;  ///< the campaign's own files, manifest first
};

ReadCampaign read_campaign(const std::filesystem::path& folder, const Context& context,
                           const Stage& stage);

/// What a verb about one campaign works with.
struct Workplace {
  loader::Plugins plugins;
  Context context;
  std::vector<std::string> notes;  ///< plugins that were refused
};

/// What `open_workplace` reads of the templates: fonts and words of other languages take a third of
/// the time of a short command. With the library its causes are effects that can be named.
enum class TemplatesFor { documents, terminal, terminal_with_library };

/// Plugins, templates and the site.toml of the nearest folder above the campaign that has one.
Expected<std::unique_ptr<Workplace>> open_workplace(
    const std::filesystem::path& campaign, const std::vector<std::filesystem::path>& plugin_folders,
    const std::vector<std::filesystem::path>& template_folders, const std::string& version,
    TemplatesFor what = TemplatesFor::documents);

}  // namespace nonio::reading
