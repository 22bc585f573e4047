// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "nonio/host/files.h"
#include "nonio/host/run.h"
#include "progress.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

const char* to_text(host::CampaignState::Action action) {
  switch (action) {
    case host::CampaignState::Action::todo:
      return "to do";
    case host::CampaignState::Action::done:
      return "done";
    case host::CampaignState::Action::unchanged:
      break;
  }
  return "unchanged";
}

void print_night_plan(const host::Night& night, bool json) {
  for (const host::CampaignState& c : night.campaigns) {
    const bool collides = c.action == host::CampaignState::Action::todo && c.status == "failed";
    const std::string reason = collides ? c.errors.front().message : c.reason;
    if (json)
      std::cout << Json{{"id", c.id},
                        {"folder", host::path_text(c.folder)},
                        {"action", collides ? "refused" : to_text(c.action)},
                        {"reason", reason}}
                       .dump(-1, ' ', false, Json::error_handler_t::replace)
                << "\n";
    else
      std::cout << (collides ? "refused" : to_text(c.action)) << "  " << c.id << ": " << reason
                << "\n";
  }
}

void print_summary(const host::Night& night, const fs::path& out, bool json) {
  std::size_t done = 0, unchanged = 0, attention = 0, failed = 0;
  for (const host::CampaignState& c : night.campaigns) {
    if (c.status == "failed")
      ++failed;
    else if (c.action == host::CampaignState::Action::done)
      ++done;
    else
      ++unchanged;
    if (c.status == "attention") ++attention;
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
  host::RunOptions options;
};

int run_night(RunWish& wish, const Common& common) {
  const char* const verb = "nonio run";
  if (wish.out.empty()) return complain(verb, "--out is empty; wanted a folder");
  host::RunOptions& options = wish.options;
  options.site = wish.site;
  options.out = fs::absolute(wish.out);
  options.plugin_folders = common.plugin_folders();
  options.own_plugins = Common::own_plugins();
  options.template_folders = common.template_folders();
  options.version = NONIO_VERSION;
  struct sigaction action {};
  action.sa_handler = [](int) { host::request_stop(); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  Progress progress(common.quiet, common.json);
  const host::Night night = host::run_site(options, progress.events());
  progress.end();
  if (night.end == host::Night::End::refused) return complain(verb, night.error);
  if (night.end == host::Night::End::interrupted)
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
  host::RunOptions& options = wish->options;
  using Takes = Argument::Takes;
  return {
      .name = "run",
      .summary = "The nightly job: every campaign below SITE through its analyses and outputs",
      .arguments = joined(
          {required(existing(Takes::folder,
                             {"SITE", &wish->site,
                              "Folder in which every folder with a campaign.toml is a campaign"})),
           required(takes(Takes::folder,
                          {"--out", &wish->out,
                           "Folder for the results: one folder a campaign, and the summary"})),
           within(1, 1024,
                  {"--jobs", &options.jobs, "Campaigns at a time (default: one for each core)"}),
           {"--force", &options.force, "Do every campaign again, changed or not"},
           {"--dry-run", &options.dry_run, "Say what would be done and why; do nothing"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "A campaign is done again only if something it depends on has changed: its files, "
          "site.toml,\n"
          "a plugin, a template, the program. A run that was killed goes on where it stopped.\n\n"
          "Example: nonio run samples/site --out out",
      .run = [wish, &common] { return run_night(*wish, common); }};
}

}  // namespace nonio::app
