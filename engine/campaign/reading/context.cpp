// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/context.h"

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/reading/campaign_reader.h"
#include "platform/process/apart.h"

namespace nonio::reading {

std::string input_name(const std::string& file) { return "file " + file; }
std::string shared_name(const std::string& file) { return "shared " + file; }

Inputs shared_inputs(const Context& context) {
  return {{"site.toml", context.site_sha256},
          {"plugins", context.plugins_sha256},
          {"templates", context.template_texts.sha256},
          {"version", context.version}};
}

namespace fs = std::filesystem;

Expected<std::unique_ptr<Workplace>> open_workplace(const fs::path& campaign,
                                                    const std::vector<fs::path>& plugin_folders,
                                                    const std::vector<fs::path>& template_folders,
                                                    const std::string& version, TemplatesFor what) {
  std::error_code error;
  if (!fs::is_directory(campaign, error))
    return fail("there is no folder " + campaign.string() + "; expected the folder of a campaign");
  if (!fs::exists(campaign / config::manifest_name, error))
    return fail("there is no " + std::string(config::manifest_name) + " in " + campaign.string() +
                ": it is not the folder of a campaign");
  auto place = std::make_unique<Workplace>();
  Context& context = place->context;
  context.version = version;
  context.every_cause = what != TemplatesFor::terminal;
  const fs::path site = config::site_of(campaign);
  auto read = config::read_site(site, context.site_sha256);
  if (!read) return fail(read.error().front());
  context.site = std::move(*read);
  NONIO_TRY(auto machines, config::read_machines(site));
  context.machines = std::move(machines);
  auto secrets = config::secret_files(context.site, site);
  // A site without site.toml cannot be found from its campaign.
  for (fs::path above = fs::absolute(campaign); above.has_relative_path();
       above = above.parent_path())
    secrets.push_back(above / config::users_name);
  process::hide_from_plugins(std::move(secrets));
  place->plugins.load(plugin_folders);
  if (!place->plugins.conflicts().empty()) return fail(place->plugins.conflicts().front());
  place->notes = place->plugins.refusal_notes();
  const auto note = [&](const Error& warning) {
    place->notes.push_back(warning.file + ":" + std::to_string(warning.line) + ": " +
                           warning.message);
  };
  for (const Error& warning : context.site.warnings) note(warning);
  context.plugins = &place->plugins;
  // Templates are read after the fork for plugins, because freeing them in the plugin process would
  // copy each page.
  NONIO_TRY(const auto folders, config::with_site_templates(template_folders, site));
  std::vector<std::string> below;
  if (what != TemplatesFor::documents) below = config::words_in(context.site.language);
  NONIO_TRY(context.templates, config::read_templates(folders, {}, below));
  for (const Error& warning : config::warnings_of_causes(context.templates)) note(warning);
  return place;
}

}  // namespace nonio::reading
