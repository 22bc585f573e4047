// SPDX-License-Identifier: Apache-2.0
#include "set_up.h"

#include <ctime>

#include "context.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

std::string all_of(const std::vector<Error>& errors) {
  std::string text;
  for (const Error& e : errors)
    text += (text.empty() ? "" : "\n") + e.file +
            (e.line != 0 ? ":" + std::to_string(e.line) : "") + (e.file.empty() ? "" : ": ") +
            e.message;
  return text;
}

/// What the morning's reader should know of the key.
void note_key(SetUp& place, bool is_stamped) {
  constexpr sign::Time month = sign::Time{30} * 86400;
  std::vector<std::string>& notes = place.notes;
  const auto who = place.signer->start();
  if (!who) {
    place.no_key = who.error().message;
    notes.push_back("nothing can be signed: " + place.no_key);
  } else if (who->not_after - std::time(nullptr) < month) {
    notes.push_back("the signing certificate of " + who->subject + " runs out on " +
                    sign::text_of(who->not_after) + ": have a new one made");
  }
  if (who && !is_stamped)
    place.unstamped =
        "no time-stamp server is named (time_stamp in [signing] of site.toml): what is signed "
        "holds until the certificate of " +
        who->subject + " runs out on " + sign::text_of(who->not_after) + ", and no longer";
}

}  // namespace

Expected<std::unique_ptr<SetUp>> set_up(const RunOptions& options) {
  auto place = std::make_unique<SetUp>();
  Context& context = place->context;
  context.version = options.version;
  auto site = read_site(options.site, context.site_sha256);
  if (!site) return fail(all_of(site.error()));
  context.site = std::move(*site);
  place->notes = context.site.notes;
  if (context.site.signing && !options.dry_run) {  // before any plugin is in the memory
    place->signer.emplace(*context.site.signing, options.site);
    note_key(*place, !context.site.signing->time_stamp.empty());
  }
  const auto template_folders = with_site_templates(options.template_folders, options.site);
  if (!template_folders) return fail(template_folders.error());
  auto templates =
      read_templates(*template_folders, context.templates_sha256, &context.templates_json);
  if (!templates) return fail(all_of({templates.error()}));
  context.templates = std::move(*templates);
  Plugins& plugins = place->plugins;
  plugins.load(options.plugin_folders);
  if (!plugins.conflicts().empty()) return fail(plugins.conflicts().front());
  for (std::string& note : plugins.refusal_notes()) place->notes.push_back(std::move(note));
  context.plugins = &plugins;
  context.plugins_sha256 = plugins.digest();
  if (const auto mistakes = site_mistakes(context); !mistakes.empty())
    return fail(all_of(mistakes));
  return place;
}

}  // namespace nonio::host
