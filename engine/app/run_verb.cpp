// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <iostream>
#include <memory>

#include "batch/close/summary.h"
#include "batch/shards/parts.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "progress.h"
#include "run_common.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

const char* to_text(batch::CampaignState::Action action) {
  switch (action) {
    case batch::CampaignState::Action::todo:
      return "to do";
    case batch::CampaignState::Action::done:
      return "done";
    case batch::CampaignState::Action::unchanged:
      break;
  }
  return "unchanged";
}

void print_run_plan(const batch::RunResult& run, const config::TerminalWords& words, bool json) {
  for (const batch::CampaignState& c : run.campaigns) {
    const bool collides =
        c.action == batch::CampaignState::Action::todo && c.status == evaluation::Status::failed;
    const std::string reason = collides ? c.errors.front().message : c.reason;
    if (json)
      print_json(Json{{"id", c.id},
                      {"folder", storage::path_text(c.folder)},
                      {"action", collides ? "refused" : to_text(c.action)},
                      {"reason", reason}},
                 -1);
    else
      std::cout << words(std::string("plan.") + (collides ? "refused" : to_text(c.action))) << "  "
                << c.id << ": " << batch::reason_in(reason, words) << "\n";
  }
}

// Value of --shard if the option is missing. An empty value, such as that of an unset variable in
// --shard "$UNSET", is an error, because it must not start a whole run on every host.
constexpr const char* not_given = "not given";

struct RunWish {
  std::string site, out, scratch;
  std::string shard = not_given;
  batch::RunOptions options;
};

std::string take_shard(RunWish& wish) {
  batch::RunOptions& options = wish.options;
  if (options.force || options.verify_results || options.dry_run || !options.date.empty() ||
      !options.only.empty())
    return "--shard goes with --jobs and --pack alone: whether and when campaigns are done is "
           "planned (nonio run plan --help)";
  const char* const end = wish.shard.data() + wish.shard.size();
  const auto number = std::from_chars(wish.shard.data(), end, options.shard);
  const bool is_number = number.ec == std::errc() && number.ptr != end && *number.ptr == '/';
  const auto of = is_number ? std::from_chars(number.ptr + 1, end, options.shards)
                            : std::from_chars_result{number.ptr, std::errc::invalid_argument};
  if (of.ec != std::errc() || of.ptr != end || options.shard >= options.shards)
    return "--shard: expected i/S with i = 0 .. S-1, for example 0/4, found \"" + wish.shard + "\"";
  options.step = batch::RunOptions::Step::shard;
  return {};
}

int run_part(const batch::RunOptions& options, const Common& common) {
  Progress progress(common, common.quiet, common.json);
  const batch::RunResult run = batch::run_shard(options, progress.events());
  progress.end();
  if (const auto exit = exit_of_unfinished(run)) return *exit;
  const auto left = static_cast<std::size_t>(
      std::count_if(run.campaigns.begin(), run.campaigns.end(),
                    [](const auto& c) { return c.action == batch::CampaignState::Action::todo; }));
  const std::size_t failed = run.failed(), done = run.campaigns.size() - left - failed;
  if (common.json)
    std::cout << Json{{"event", "end"},         {"night", run.run.number},
                      {"shard", options.shard}, {"shards", options.shards},
                      {"done", done},           {"failed", failed},
                      {"left_to_merge", left}}
                     .dump()
              << "\n";
  else if (!common.quiet)
    std::cout << progress.words()("run.shard", {{"number", std::to_string(options.shard)},
                                                {"count", std::to_string(options.shards)},
                                                {"done", std::to_string(done)},
                                                {"failed", std::to_string(failed)}})
              << (left == 0 ? ""
                            : ", " + progress.words()("run.left_to_merge",
                                                      {{"count", std::to_string(left)}}))
              << "\n";
  return failed > 0 ? exit_failed : exit_done;
}

int run_site_again(RunWish& wish, const Common& common) {
  if (wish.out.empty()) return complain("--out is empty; expected a folder");
  batch::RunOptions& options = wish.options;
  if (!options.only.empty() && (options.force || !options.date.empty()))
    return complain("--only goes with neither --force nor --date");
  if (wish.shard == not_given && (options.pack || !wish.scratch.empty()))
    return complain("--pack and --scratch are of a shard; expected --shard i/S with them");
  if (!wish.scratch.empty() && !options.pack)
    return complain("--scratch is where a packed shard works; expected --pack with it");
  options.scratch = wish.scratch;
  if (wish.shard != not_given) {
    if (const auto wrong = take_shard(wish); !wrong.empty()) return complain(wrong);
    prepare_run(options, wish.site, wish.out, common);
    return run_part(options, common);
  }
  prepare_run(options, wish.site, wish.out, common);
  Progress progress(common, common.quiet, common.json);
  const batch::RunResult run = batch::run_site(options, progress.events());
  progress.end();
  if (const auto exit = exit_of_unfinished(run)) return *exit;
  // Failures of earlier runs are reported again, so that no failed campaign is overlooked.
  if (!common.json && !options.dry_run) progress.still_failed(run);
  if (options.dry_run)
    print_run_plan(run, progress.words(), common.json);
  else if (!common.quiet || common.json)
    print_summary(run, options.out, progress.words(), common.json);
  return run.any_failed() ? exit_failed : exit_done;
}

}  // namespace

Verb run_verb(Common& common) {
  auto wish = std::make_shared<RunWish>();
  batch::RunOptions& options = wish->options;
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
           jobs_argument(options),
           {"--force", &options.force, "Evaluate every campaign again, changed or not"},
           {"--only", &options.only,
            "Evaluate a single campaign (folder or id) of the last run again; all other results "
            "are kept, and the run keeps its number"},
           {"--verify-results", &options.verify_results,
            "Compare the digests of all result files, not only of those that look modified; a "
            "campaign with a modified file is evaluated again"},
           day({"--date", &options.date,
                "Date of the run, YYYY-MM-DD, for the summary (default: today; a resumed run keeps "
                "its date)"}),
           {"--dry-run", &options.dry_run, "Print what would be evaluated and why; write nothing"},
           {"--shard", &wish->shard,
            "i/S: only shard i = 0 .. S-1 of a run that `nonio run plan` has divided into S "
            "shards; on any host that has SITE and OUT, in any order, also more than once"},
           {"--pack", &options.pack,
            "With --shard: work in a folder of this host and store the results as one file in "
            "OUT/.nonio/packs. Every command reads them there; `nonio export` writes them into "
            "folders"},
           existing(Takes::folder, {"--scratch", &wish->scratch,
                                    "With --pack: the folder of this host (default: TMPDIR, or "
                                    "/tmp). It needs room for the results of the shard, twice"}),
           root_argument(options),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "A campaign is evaluated again only if its files, site.toml, a plugin, a template or the "
          "program have changed. A run that was killed resumes where it stopped.",
      .examples = {"nonio run samples/site --out out"},
      .run = [wish, &common] { return run_site_again(*wish, common); }};
}

}  // namespace nonio::app
