// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/set_up.h"

#include <sys/stat.h>
#include <unistd.h>

#include <ctime>

#include "batch/state/read_apart.h"
#include "batch/workers/runner.h"
#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"

namespace nonio::batch {
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

/// Notes that no signature is possible, or that the signing certificate expires within 30 days.
/// Sets `unstamped` without a time-stamp server.
void note_key(SetUp& place, bool is_stamped) {
  constexpr sign::Time month = sign::Time{30} * 86400;
  std::vector<std::string>& notes = place.notes;
  const auto who = place.signer->start();
  if (!who) {
    place.no_key = who.error().message;
    notes.push_back("nothing can be signed: " + place.no_key);
  } else if (who->not_after - std::time(nullptr) < month) {
    notes.push_back("the signing certificate of " + who->subject + " expires on " +
                    sign::text_of(who->not_after) + "; request a new one");
  }
  if (who && !is_stamped)
    place.unstamped =
        "no time-stamp server is configured (time_stamp in [signing] of site.toml): signatures can "
        "be verified only until the certificate of " +
        who->subject + " expires on " + sign::text_of(who->not_after) +
        " (`nonio certificate extend` can add a time stamp until then)";
}

/// Returns a plugin or plugin folder that other users than root and the owner of the program can
/// change; empty if there is none. The program's own folder is excluded, because whoever can change
/// it can change the program.
std::string changeable_by_others(const RunOptions& options) {
  struct stat own {};
  ::stat(options.own_plugins.c_str(), &own);
  const auto others_can = [&](const fs::path& path) {
    struct stat info {};
    return ::stat(path.c_str(), &info) == 0 && ((info.st_uid != 0 && info.st_uid != own.st_uid) ||
                                                (info.st_mode & (S_IWGRP | S_IWOTH)) != 0);
  };
  std::vector<fs::path> folders = options.plugin_folders;
  std::erase(folders, options.own_plugins);
  for (const fs::path& folder : folders)
    if (others_can(folder)) return folder.string();
  loader::Plugins none;
  for (const fs::path& file : none.files_in(folders))
    if (others_can(file)) return file.string();
  return {};
}

/// Root must not run plugins that other users can change, because a gap in the confinement would
/// give these users root's rights.
Expected<void> check_user(const RunOptions& options) {
  if (::geteuid() != 0 || options.as_root) return {};
  if (const std::string path = changeable_by_others(options); !path.empty())
    return fail("root would run code that other users can change: " + path +
                "; expected another user (the package's service runs as nonio), or --root");
  return {};
}

Expected<void> load_plugins(SetUp& place, const RunOptions& options) {
  PluginHost& host = place.host.emplace(
      PluginHost::Request{options.plugin_folders, library_folders(options.own_plugins),
                          config::secret_files(place.context.site, options.site), place.context,
                          process::is_stop_requested, options.confine});
  NONIO_TRY(auto catalogue, host.start());
  place.plugins = loader::Plugins(std::move(catalogue));
  place.notes.insert(place.notes.end(), host.notes().begin(), host.notes().end());
  return {};
}

}  // namespace

Expected<std::unique_ptr<SetUp>> set_up(const RunOptions& options) {
  auto place = std::make_unique<SetUp>();
  reading::Context& context = place->context;
  context.version = options.version;
  context.today = reading::day_of_clock();
  const auto files = read_apart<config::SiteFiles>(
      "the site " + options.site.string(), config::Limits{}.disk_seconds,
      [&](process::SignsOfLife& signs) {
        return config::read_site_files(options.site,
                                       [&](const fs::path& path) { signs.reading(path.string()); });
      });
  if (!files) return fail(all_of({files.error()}));
  NONIO_TRY(auto parts, SiteParts::compare(options.site, options.out));
  place->parts = std::move(parts);
  if (const std::string why = place->parts.refusal(); !why.empty()) return fail(why);
  auto site = config::site_in(*files, context.site_sha256);
  if (!site) return fail(all_of(site.error()));
  context.site = std::move(*site);
  for (const Error& warning : context.site.warnings) place->notes.push_back(all_of({warning}));
  auto machines = config::read_machines(options.site);
  if (!machines) return fail(all_of({machines.error()}));
  place->parts.complete(*machines);
  context.machines = std::move(*machines);
  const bool signs =
      options.step == RunOptions::Step::whole || options.step == RunOptions::Step::merge;
  // The process with the key is started before any plugin is loaded, so that it contains no plugin
  // code.
  if (context.site.signing && !options.dry_run && signs) {
    place->signer.emplace(*context.site.signing, options.site, context.site.limits.disk_seconds);
    note_key(*place, !context.site.signing->time_stamp.empty());
  }
  auto templates =
      config::read_templates(options.template_folders, files->templates, {},
                             &context.template_texts, context.site.signing.has_value());
  if (!templates) return fail(all_of({templates.error()}));
  context.templates = std::move(*templates);
  // Read before the fork, so that no process that evaluates reads them again.
  for (const std::string& language : {std::string("en"), context.site.language})
    context.templates.tables.read(language);
  for (const Error& warning : config::warnings_of_causes(context.templates))
    place->notes.push_back(all_of({warning}));
  if (auto allowed = check_user(options); !allowed) return fail(allowed.error());
  if (auto loaded = load_plugins(*place, options); !loaded) return fail(loaded.error());
  const loader::Plugins& plugins = place->plugins;
  if (!plugins.conflicts().empty()) return fail(plugins.conflicts().front());
  for (std::string& note : plugins.refusal_notes()) place->notes.push_back(std::move(note));
  context.plugins = &plugins;
  NONIO_TRY(auto digest, plugins.digest());
  context.plugins_sha256 = std::move(digest);
  if (const auto mistakes = reading::site_mistakes(context); !mistakes.empty())
    return fail(all_of(mistakes));
  return place;
}

}  // namespace nonio::batch
