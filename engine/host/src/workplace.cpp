// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "apart.h"
#include "context.h"
#include "nonio/host/campaign_reader.h"
#include "nonio/host/files.h"
#include "signer.h"

namespace nonio::host {
namespace fs = std::filesystem;

fs::path site_of(const fs::path& campaign) {
  std::error_code error;
  const fs::path start = fs::canonical(campaign, error);
  // One that cannot be looked at is not none: reading it says what is wrong.
  const auto has = [](const char* name) {
    return [name](const fs::path& folder) { return is_there(folder / name).value_or(true); };
  };
  const auto nearest = [&](const auto& is_it) -> std::optional<fs::path> {
    for (fs::path folder = start; !error && !folder.empty(); folder = folder.parent_path()) {
      if (is_it(folder)) return folder;
      if (folder == folder.parent_path()) break;
    }
    return std::nullopt;
  };
  if (const auto site = nearest(has(site_name))) return *site;
  return nearest(has(machines_folder)).value_or(campaign);
}

Expected<std::unique_ptr<Workplace>> open_workplace(const fs::path& campaign,
                                                    const std::vector<fs::path>& plugin_folders,
                                                    const std::vector<fs::path>& template_folders,
                                                    const std::string& version, TemplatesFor what) {
  std::error_code error;
  if (!fs::is_directory(campaign, error))
    return fail("there is no folder " + campaign.string() + "; wanted the folder of a campaign");
  if (!fs::exists(campaign / manifest_name, error))
    return fail("there is no " + std::string(manifest_name) + " in " + campaign.string() +
                ": it is not the folder of a campaign");
  auto place = std::make_unique<Workplace>();
  Context& context = place->context;
  context.version = version;
  const fs::path site = site_of(campaign);
  auto read = read_site(site, context.site_sha256);
  if (!read) return fail(read.error().front());
  context.site = std::move(*read);
  auto machines = read_machines(site);
  if (!machines) return fail(machines.error());
  context.machines = std::move(*machines);
  const auto folders = with_site_templates(template_folders, site);
  if (!folders) return fail(folders.error());
  auto templates = read_templates(*folders, context.templates_sha256, nullptr, {},
                                  what == TemplatesFor::documents ? "" : "words/en/");
  if (!templates) return fail(templates.error());
  context.templates = std::move(*templates);
  if (context.site.signing) hide_from_plugins(secret_files(*context.site.signing, site));
  place->plugins.load(plugin_folders);
  if (!place->plugins.conflicts().empty()) return fail(place->plugins.conflicts().front());
  place->notes = place->plugins.refusal_notes();
  context.plugins = &place->plugins;
  return place;
}

}  // namespace nonio::host
