// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "batch/shards/packed_shard.h"
#include "batch/state/output_lock.h"
#include "batch/state/run_plan.h"
#include "batch/state/run_state.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "progress.h"
#include "run_common.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t most_shards = 100000;

struct PartWish {
  std::string site, out, alive;
  batch::RunOptions options;
};

void print_planned(const batch::RunResult& run, const batch::RunOptions& options,
                   const config::TerminalWords& say, bool json) {
  const auto& shards = run.planned;
  std::uint64_t in_shards = 0;
  for (const std::uint64_t n : shards) in_shards += n;
  const auto to_do = static_cast<std::uint64_t>(
      std::count_if(run.campaigns.begin(), run.campaigns.end(),
                    [](const auto& c) { return c.action == batch::CampaignState::Action::todo; }));
  if (json) {
    std::cout << Json{{"schema", "nonio-night-plan/1"},
                      {"night", run.run.number},
                      {"date", run.run.date},
                      {"campaigns", run.campaigns.size()},
                      {"to_do", to_do},
                      {"left_to_merge", to_do - in_shards},
                      {"vanished", run.vanished.size()},
                      {"shards", shards}}
                     .dump()
              << "\n";
    return;
  }
  const auto [least, most] = std::minmax_element(shards.begin(), shards.end());
  const auto number = [](std::uint64_t n) { return std::to_string(n); };
  const std::string sizes =
      *least == *most ? number(*least)
                      : say("run.range", {{"least", number(*least)}, {"most", number(*most)}});
  const std::size_t width = sentence_width(STDOUT_FILENO);
  std::cout << wrapped(say("run.shards-planned",
                           {{"run", say("night-of", {{"number", number(run.run.number)},
                                                     {"date", run.run.date}})},
                            {"campaigns", say.counted("campaigns", run.campaigns.size())},
                            {"todo", number(to_do)},
                            {"count", number(in_shards)},
                            {"shards", say.counted("run.shards", shards.size())},
                            {"sizes", sizes},
                            {"left", number(to_do - in_shards)}}),
                       0, width, 2)
            << wrapped(say("run.shards-next", {{"count", number(shards.size())},
                                               {"last", number(shards.size() - 1)},
                                               {"out", options.out.string()}}),
                       0, width, 2);
}

int plan_run(PartWish& wish, const Common& common) {
  batch::RunOptions& options = wish.options;
  if (wish.out.empty()) return complain("--out is empty; expected a folder");
  options.step = batch::RunOptions::Step::plan;
  prepare_run(options, wish.site, wish.out, common);
  Progress progress(common, common.quiet, common.json);
  const batch::RunResult run = batch::run_site(options, progress.events());
  progress.end();
  if (const auto exit = exit_of_unfinished(run)) return *exit;
  if (!common.quiet || common.json) print_planned(run, options, progress.words(), common.json);
  return exit_done;
}

int already_merged(const batch::RunStatus& status, const Common& common) {
  const std::uint64_t failed = status.last ? status.last->failed : 0;
  if (!common.quiet)
    std::cerr << "nonio: run " << status.run.number << " is complete: there is nothing to merge\n";
  return failed > 0 ? exit_failed : exit_done;
}

int merge_run(PartWish& wish, const Common& common) {
  batch::RunOptions& options = wish.options;
  const auto plan = batch::find_plan(wish.out);
  if (!plan) return complain(plan.error().message);
  if (!*plan) {
    const auto status = batch::run_status(wish.out);
    if (status && status->state == batch::RunStatus::State::complete)
      return already_merged(*status, common);
    return complain(batch::read_plan(wish.out).error().message);
  }
  options.step = batch::RunOptions::Step::merge;
  const std::string site = wish.site.empty() ? (*plan)->site : wish.site;
  std::error_code error;
  if (!fs::is_directory(site, error))
    return complain("the site " + site +
                    ", for which the run was planned, is not on this host; expected --site FOLDER");
  prepare_run(options, site, wish.out, common);
  Progress progress(common, common.quiet, common.json);
  const batch::RunResult run = batch::run_site(options, progress.events());
  progress.end();
  if (const auto exit = exit_of_unfinished(run)) return *exit;
  if (!common.json) progress.still_failed(run);
  if (!common.quiet || common.json) print_summary(run, options.out, progress.words(), common.json);
  return run.any_failed() ? exit_failed : exit_done;
}

int cancel_run(const PartWish& wish, const Common& common) {
  const auto plan = batch::find_plan(wish.out);
  if (plan && !*plan) return complain(batch::read_plan(wish.out).error().message);
  const auto lock = batch::OutputLock::take(wish.out, batch::OutputLock::Use::planned);
  if (!lock) return complain(lock.error().message);
  if (const auto kept = batch::keep_packs(wish.out); !kept) return complain(kept.error().message);
  if (const auto removed = batch::remove_plan(wish.out); !removed)
    return complain(removed.error().message);
  if (!common.quiet)
    std::cerr << "nonio: the plan is withdrawn; `nonio run SITE --out OUT` or another plan goes on "
                 "with the same run, and keeps the finished shards\n";
  return exit_done;
}

int unlock_folder(const PartWish& wish, const Common& common) {
  std::optional<std::string> alive;
  if (!wish.alive.empty()) {
    auto text = storage::read_file(wish.alive);
    if (!text) return complain(text.error().message);
    alive = std::move(*text);
  }
  const auto gone = batch::unlock(wish.out, alive);
  if (!gone) return complain(gone.error().message);
  if (!common.quiet)
    std::cerr << "nonio: "
              << (gone->empty() ? "the output folder is not in use"
                                : "the output folder is free; it was used by " + *gone)
              << "\n";
  return exit_done;
}

Argument out_argument(PartWish& wish) {
  return required(
      existing(Argument::Takes::folder, {"OUT", &wish.out, "Output folder of the planned run"}));
}

Verb plan_part(Common& common) {
  auto wish = std::make_shared<PartWish>();
  batch::RunOptions& options = wish->options;
  using Takes = Argument::Takes;
  return {
      .name = "plan",
      .summary = "Divides the campaigns that have to be evaluated into S shards",
      .arguments = joined(
          {required(existing(Takes::folder,
                             {"SITE", &wish->site,
                              "Folder in which every folder with a campaign.toml is a campaign"})),
           required(takes(Takes::folder,
                          {"--out", &wish->out, "Folder for the results, shared by all hosts"})),
           required(within(1, most_shards,
                           {"--shards", &options.shards,
                            "S, the number of shards; 4 to 8 times as many as run at a time"})),
           {"--force", &options.force, "Evaluate every campaign again, changed or not"},
           {"--verify-results", &options.verify_results,
            "Compare the digests of all result files, not only of those that look modified"},
           day({"--date", &options.date,
                "Date of the run, YYYY-MM-DD, for the summary (default: today; a resumed run keeps "
                "its "
                "date)"}),
           root_argument(options),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Reads the site and the register of numbers; needs no key. The shard of a campaign is "
          "the SHA-256 of its id (first 8 bytes) modulo S. Re-planning replaces a plan that was "
          "not merged; finished shards are kept. Until the merge, `nonio "
          "run` without --shard is rejected.",
      .examples = {"nonio run plan site --out out --shards 4"},
      .run = [wish, &common] { return plan_run(*wish, common); }};
}

Verb merge_part(Common& common) {
  auto wish = std::make_shared<PartWish>();
  batch::RunOptions& options = wish->options;
  options.patience = 3.0;
  Argument wait = within(0, 3600,
                         {"--wait", &options.patience,
                          "Seconds for results of other hosts to appear on a shared file system"});
  wait.shows_default = true;
  return {
      .name = "merge",
      .summary = "Completes a planned run when its shards are done: history, pages, summary",
      .arguments = joined(
          {out_argument(*wish),
           existing(Argument::Takes::folder,
                    {"--site", &wish->site, "The site, where this host has it in another place"}),
           jobs_argument(options), wait, root_argument(options), templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Runs on the host that has the key and reaches the register: campaigns with a "
          "certificate or a signature are done here, in the order of their ids. Summary, history "
          "and pages have the same bytes as those of an undivided run. Exit status "
          "1 also if a shard has not reported: the message names it. Run it, then merge again; "
          "nothing is merged twice.",
      .examples = {"nonio run merge out"},
      .run = [wish, &common] { return merge_run(*wish, common); }};
}

Verb cancel_part(Common& common) {
  auto wish = std::make_shared<PartWish>();
  return {.name = "cancel",
          .summary = "Withdraws a plan; the results of finished shards are kept",
          .arguments = joined({out_argument(*wish)}, common_arguments(common)),
          .footer =
              "The command is rejected while a shard is running. The run stays open: `nonio run` "
              "without --shard, or another plan, continues it.",
          .examples = {"nonio run cancel out"},
          .run = [wish, &common] { return cancel_run(*wish, common); }};
}

Verb unlock_part(Common& common) {
  auto wish = std::make_shared<PartWish>();
  using Takes = Argument::Takes;
  return {
      .name = "unlock",
      .summary = "Frees an output folder whose process on another host has ended",
      .arguments = joined(
          {required(existing(Takes::folder, {"OUT", &wish->out, "Output folder of `nonio run`"})),
           existing(Takes::file, {"--alive", &wish->alive,
                                  "The scheduler's list of jobs, a job in each line: refused if "
                                  "its job (NONIO_JOB of its environment) is in it"})},
          common_arguments(common)),
      .footer =
          "A process that writes to the output folder stores its host and process id in "
          "OUT/.nonio/user. After a crash the same host takes the folder over by itself, also "
          "after a restart. Another host cannot know whether the process is still running; use "
          "this command if you, or the scheduler, know that it has ended. Refused if the lock of "
          "the file system shows that the process is running.",
      .examples = {"nonio run unlock out"},
      .run = [wish, &common] { return unlock_folder(*wish, common); }};
}

}  // namespace

std::vector<Verb> run_parts(Common& common) {
  return {plan_part(common), merge_part(common), cancel_part(common), unlock_part(common)};
}

}  // namespace nonio::app
