// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/batch/run.h"
#include "host/storage/files.h"
#include "progress.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

const char* to_text(host::batch::CampaignState::Action action) {
  switch (action) {
    case host::batch::CampaignState::Action::todo:
      return "to do";
    case host::batch::CampaignState::Action::done:
      return "done";
    case host::batch::CampaignState::Action::unchanged:
      break;
  }
  return "unchanged";
}

void print_night_plan(const host::batch::Night& night, bool json) {
  for (const host::batch::CampaignState& c : night.campaigns) {
    const bool collides = c.action == host::batch::CampaignState::Action::todo &&
                          c.status == host::evaluation::Status::failed;
    const std::string reason = collides ? c.errors.front().message : c.reason;
    if (json)
      std::cout << Json{{"id", c.id},
                        {"folder", host::storage::path_text(c.folder)},
                        {"action", collides ? "refused" : to_text(c.action)},
                        {"reason", reason}}
                       .dump(-1, ' ', false, Json::error_handler_t::replace)
                << "\n";
    else
      std::cout << (collides ? "refused" : to_text(c.action)) << "  " << c.id << ": " << reason
                << "\n";
  }
}

void print_summary(const host::batch::Night& night, const fs::path& out, bool json) {
  std::size_t done = 0, unchanged = 0, attention = 0, failed = 0;
  for (const host::batch::CampaignState& c : night.campaigns) {
    if (c.status == host::evaluation::Status::failed)
      ++failed;
    else if (c.action == host::batch::CampaignState::Action::done)
      ++done;
    else
      ++unchanged;
    if (c.status == host::evaluation::Status::attention) ++attention;
  }
  if (json)
    std::cout << Json{{"event", "end"},
                      {"done", done},
                      {"unchanged", unchanged},
                      {"attention", attention},
                      {"failed", failed},
                      {"vanished", night.vanished.size()},
                      {"summary", (out / "summary.json").string()}}
                     .dump(-1, ' ', false, Json::error_handler_t::replace)
              << "\n";
  else
    std::cout << done << " done, " << unchanged << " unchanged, " << failed << " failed; "
              << (night.vanished.empty() ? ""
                                         : std::to_string(night.vanished.size()) + " vanished; ")
              << attention << (attention == 1 ? " asks" : " ask")
              << " for attention: " << (out / "summary.txt").string() << "\n";
}

struct RunWish {
  std::string site, out;
  host::batch::RunOptions options;
};

/// Whoever ends the run, or the terminal that it was started from, leaves a night that the next run
/// goes on with. Under nohup a lost terminal is nothing to stop for. A reader of the output that
/// went away, or a limit for the size of files, is no reason to die but an error like others.
void catch_signals() {
  struct sigaction stop {};
  stop.sa_handler = [](int) { host::process::request_stop(); };
  sigaction(SIGINT, &stop, nullptr);
  sigaction(SIGTERM, &stop, nullptr);
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &stop, nullptr);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

int run_night(RunWish& wish, const Common& common) {
  const char* const verb = "nonio run";
  if (wish.out.empty()) return complain(verb, "--out is empty; expected a folder");
  host::batch::RunOptions& options = wish.options;
  if (!options.date.empty() && !is_day(options.date))
    return complain(verb, "--date: expected a day as YYYY-MM-DD, found \"" + options.date + "\"");
  if (!options.only.empty() && (options.force || !options.date.empty()))
    return complain(verb, "--only goes with neither --force nor --date");
  options.site = wish.site;
  options.out = fs::absolute(wish.out);
  options.plugin_folders = common.plugin_folders();
  options.own_plugins = Common::own_plugins();
  options.template_folders = common.template_folders();
  options.version = NONIO_VERSION;
  options.as_root = options.as_root || std::getenv("NONIO_ALLOW_ROOT") != nullptr;
  catch_signals();
  if (::geteuid() == 0 && !options.as_root && !common.quiet)
    std::cerr << "nonio: this runs as root, for whom nothing needs it: expected a user of its own "
                 "(the package's service runs as nonio), or --root to say that it is meant\n";
  Progress progress(common.quiet, common.json);
  const host::batch::Night night = host::batch::run_site(options, progress.events());
  progress.end();
  if (night.end == host::batch::Night::End::refused) return complain(verb, night.error);
  if (night.end == host::batch::Night::End::interrupted)
    return complain(verb, "interrupted; the same command goes on where it stopped",
                    exit_interrupted);
  if (!night.error.empty()) return complain(verb, night.error, exit_failed);
  // What a night before has already said is said again: a failed campaign is never silent.
  if (!common.json && !options.dry_run) progress.still_failed(night);
  if (options.dry_run)
    print_night_plan(night, common.json);
  else if (!common.quiet || common.json)
    print_summary(night, options.out, common.json);
  return night.any_failed() ? exit_failed : exit_done;
}

}  // namespace

Verb run_verb(Common& common) {
  auto wish = std::make_shared<RunWish>();
  host::batch::RunOptions& options = wish->options;
  using Takes = Argument::Takes;
  return {
      .name = "run",
      .summary = "The nightly job: evaluates every campaign in SITE and writes its outputs",
      .arguments = joined(
          {required(existing(Takes::folder,
                             {"SITE", &wish->site,
                              "Folder in which every folder with a campaign.toml is a campaign"})),
           required(takes(Takes::folder,
                          {"--out", &wish->out,
                           "Folder for the results: one folder per campaign, and the summary"})),
           within(1, 1024,
                  {"--jobs", &options.jobs, "Campaigns at a time (default: one for each core)"}),
           {"--force", &options.force, "Do every campaign again, changed or not"},
           {"--only", &options.only,
            "One campaign (its folder, or its id) of the last night again, changed or\n"
            "not; all others stay as the night left them, and the night keeps its number"},
           {"--verify-results", &options.verify_results,
            "Compare the digests of all result files, not only of those that look modified; a\n"
            "campaign with a modified file is evaluated again"},
           {"--date", &options.date,
            "Date of the night, YYYY-MM-DD, for the summary (default: today; a resumed run keeps\n"
            "its date)"},
           {"--dry-run", &options.dry_run, "Print what would be done and why; do nothing"},
           {"--root", &options.as_root,
            "Permit root, even with plugins that other users can change; or set "
            "NONIO_ALLOW_ROOT"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "A campaign is evaluated again only if its files, site.toml, a plugin, a template or "
          "the\n"
          "program have changed. A run that was killed resumes where it stopped.\n\n"
          "Example: nonio run samples/site --out out",
      .run = [wish, &common] { return run_night(*wish, common); }};
}

}  // namespace nonio::app
