// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/host/evaluate.h"

namespace nonio::host {

/// One campaign folder: what its manifest says and what its measurements hold.
struct ReadCampaign {
  std::optional<Manifest> manifest;        ///< none if it cannot be read; then nothing else is
  std::optional<MachineRecord> machine{};  ///< what the site knows of the campaign's machine
  /// Of each axis: files of the table that was on while it was measured, where it was one.
  std::map<std::string, std::vector<Artifact>> tables_on{};
  std::vector<Observations> observations;  ///< of each measurement; empty where none could be read
  std::vector<Effect> effects;             ///< of the plugins and of the campaign
  std::vector<Finding> doubts{};           ///< what makes the files themselves implausible
  std::vector<Remark> notes;
  std::vector<std::string> unread;  ///< measurements of a kind that no plugin reads
  std::vector<Error> errors;
  Inputs inputs;  ///< the campaign's own files, manifest first
};

ReadCampaign read_campaign(const std::filesystem::path& folder, const Context& context,
                           const Stage& stage);

/// Takes away the rows whose flag is 0.
void keep_rows(Observations& observations, const std::vector<char>& kept);

/// Templates that were read already: names below the folder, and bytes.
struct TemplateFiles {
  std::filesystem::path folder{};
  std::map<std::string, std::string> files{};
};

/// All template folders laid over each other, the later ones winning, and one digest of them.
/// `json`, if wanted: all of them in one text, from which `templates_from` has them again.
/// `own` wins over all folders. `below`: only files whose names begin so.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   std::string& digest, std::string* json = nullptr,
                                   const TemplateFiles& own = {}, std::string_view below = {});

/// Templates that travelled in a signed file.
struct CarriedTemplates {
  Templates templates;
  std::string sha256;                ///< as `read_templates` gives it
  std::vector<std::string> strange;  ///< names of those that differ from the installed ones
  std::string missing{};  ///< a font (they do not travel) that is not installed as it was then
};
/// An error if the text is not as `read_templates` writes it.
Expected<CarriedTemplates> templates_from(std::string_view json, const Templates& installed,
                                          std::string_view installed_json);

/// What a verb about one campaign works with.
struct Workplace {
  Plugins plugins;
  Context context;
  std::vector<std::string> notes;  ///< plugins that were refused
};

/// What `open_workplace` reads of the templates: fonts and words of other languages take a third of
/// the time of a short command.
enum class TemplatesFor { documents, english_words };

/// Plugins, templates and the site.toml of the nearest folder above the campaign that has one.
Expected<std::unique_ptr<Workplace>> open_workplace(
    const std::filesystem::path& campaign, const std::vector<std::filesystem::path>& plugin_folders,
    const std::vector<std::filesystem::path>& template_folders, const std::string& version,
    TemplatesFor what = TemplatesFor::documents);

}  // namespace nonio::host
