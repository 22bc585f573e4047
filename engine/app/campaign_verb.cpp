// SPDX-License-Identifier: Apache-2.0
#include "campaign_verb.h"

#include <iostream>

namespace nonio::app {
namespace fs = std::filesystem;

std::string text_of(const Error& e) {
  return e.file + (e.line != 0 ? ":" + std::to_string(e.line) : "") +
         (e.column.empty() ? "" : " (" + e.column + ")") + (e.file.empty() ? "" : ": ") + e.message;
}

OpenCampaign open_campaign(const char* verb, const std::string& folder, const Common& common,
                           Outcome& exit) {
  OpenCampaign open{folder, nullptr, {}};
  const auto tell = [&](const std::string& text) { std::cerr << verb << ": " << text << "\n"; };
  auto place = host::open_workplace(open.folder, common.plugin_folders(), common.template_folders(),
                                    NONIO_VERSION);
  if (!place) {
    tell(text_of(place.error()));
    exit = exit_usage;
    return open;
  }
  open.place = std::move(*place);
  if (!common.quiet)
    for (const std::string& note : open.place->notes) tell(note);
  open.read = host::read_campaign(open.folder, open.place->context, [](const std::string&) {});
  for (const Error& e : open.read.errors) tell(text_of(e));
  if (!common.quiet)
    for (const Remark& note : open.read.notes) tell(note.english);
  if (!open.read.manifest) {
    exit = exit_usage;
    return open;
  }
  bool any = false;
  for (const Observations& o : open.read.observations) any = any || o.size() > 0;
  if (!any) {
    if (open.read.errors.empty()) tell("the campaign has no readings");
    exit = exit_failed;
  }
  return open;
}

void add_campaign_arguments(CLI::App& verb, std::string& folder, Common& common) {
  verb.add_option("CAMPAIGN", folder, "Folder of one campaign: that of its campaign.toml")
      ->required()
      ->check(CLI::ExistingDirectory);
  add_templates(verb, common);
  add_common(verb, common);
}

}  // namespace nonio::app
