// SPDX-License-Identifier: Apache-2.0
#include "campaign_verb.h"

#include "nonio/sdk/format.h"

namespace nonio::app {

tl::expected<OpenCampaign, int> open_campaign(const std::string& folder, const Common& common,
                                              reading::TemplatesFor what) {
  OpenCampaign open{folder, nullptr, {}};
  auto place = reading::open_workplace(open.folder, common.plugin_folders(),
                                       common.template_folders(), NONIO_VERSION, what);
  if (!place) return tl::unexpected(complain(text_of(place.error())));
  open.place = std::move(*place);
  if (!common.quiet)
    for (const std::string& note : open.place->notes) complain(note);
  open.read = reading::read_campaign(open.folder, open.place->context, [](const std::string&) {});
  for (const Error& e : open.read.errors) complain(text_of(e));
  const reading::Context& context = open.place->context;
  const config::TerminalWords words(context.templates, context.site.language);
  if (!common.quiet)
    for (const Remark& note : open.read.notes)
      complain(words("note", {{"text", remark_text(context.templates, words.language(), note)}}));
  if (!open.read.manifest) return tl::unexpected(exit_usage);
  for (const Observations& o : open.read.observations)
    if (o.size() > 0) return open;
  if (open.read.errors.empty()) complain("the campaign has no readings");
  return tl::unexpected(exit_failed);
}

std::vector<modelling::Compared> compare_parts(std::vector<modelling::PartModel> parts,
                                               std::vector<Error>& errors) {
  std::vector<modelling::Compared> all;
  for (modelling::PartModel& part : parts)
    if (auto comparison = modelling::compare_part(part))
      all.push_back({std::move(part), std::move(*comparison)});
    else
      complain(text_of(errors.emplace_back(comparison.error())));
  return all;
}

modelling::ModelWords words_for(const OpenCampaign& open, const Common& common) {
  const reading::Context& context = open.place->context;
  return {context.templates, common.json ? "en" : context.site.language};
}

std::vector<Argument> campaign_arguments(std::string& folder, Common& common) {
  return joined(
      {required(existing(Argument::Takes::folder,
                         {"CAMPAIGN", &folder, "Folder of one campaign, with its campaign.toml"})),
       templates_argument(common)},
      common_arguments(common));
}

}  // namespace nonio::app
