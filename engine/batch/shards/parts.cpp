// SPDX-License-Identifier: Apache-2.0
#include "batch/shards/parts.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include "batch/close/shown_histories.h"
#include "batch/commit/store.h"
#include "batch/shards/packed_shard.h"
#include "batch/state/output_lock.h"
#include "batch/state/read_apart.h"
#include "batch/workers/runner.h"
#include "batch/workers/set_up.h"
#include "campaign/evaluation/record.h"
#include "certificates/numbering.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"

namespace nonio::batch {
namespace fs = std::filesystem;
using Action = CampaignState::Action;

namespace {

/// Returns a part of temporary names that is unique among all hosts.
std::string own_token() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  std::string token;
  for (const char c : std::string_view(host.data()).substr(0, 20))
    token += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  std::random_device device;
  std::array<char, 40> more{};
  std::snprintf(more.data(), more.size(), "-%ld-%08x", static_cast<long>(::getpid()), device());
  return token + more.data();
}

/// Sorts the campaigns by id. Campaigns of other shards with the same files of readings are
/// appended, or omitted if `whole_site`; they are not evaluated.
std::vector<CampaignState> states_of(std::vector<Listed> listed, bool whole_site) {
  std::stable_sort(listed.begin(), listed.end(),
                   [](const Listed& a, const Listed& b) { return a.campaign.id < b.campaign.id; });
  std::vector<CampaignState> states;
  states.reserve(listed.size());
  for (Listed& one : listed) states.push_back(std::move(one.campaign));
  const std::size_t own = states.size();
  const auto at = [&](const std::string& id) {
    const auto end = states.begin() + static_cast<std::ptrdiff_t>(own);
    const auto found =
        std::lower_bound(states.begin(), end, id,
                         [](const CampaignState& c, const std::string& x) { return c.id < x; });
    if (found != end && found->id == id) return static_cast<std::uint32_t>(found - states.begin());
    states.emplace_back();
    states.back().id = id;
    states.back().action = Action::unchanged;
    states.back().is_campaign = false;
    return static_cast<std::uint32_t>(states.size() - 1);
  };
  for (std::size_t i = 0; i < own; ++i)
    for (const auto& [digest, id] : listed[i].twins) {
      const std::uint32_t other = at(id);
      states[i].twins.emplace_back(digest, other);
    }
  if (whole_site) states.resize(own);
  return states;
}

/// Sets the outcome from a record of this run, which this shard or a copy of it has written.
/// Returns false without such a record.
bool take_stored(const fs::path& out, std::uint64_t run, CampaignState& c) {
  const auto record = evaluation::read_record(storage::results_folder(out, c.id));
  if (!record || record->run != run) return false;
  c.action = Action::done;
  c.status = record->status;
  c.errors = record->errors;
  c.reason = record->reason;
  c.shows_history = record->history.has_value();
  c.history = record->history ? record->history->sha256 : "";
  return true;
}

ShardRecord record_of(const fs::path& out, std::uint64_t run,
                      const std::vector<CampaignState>& campaigns) {
  ShardRecord record;
  std::vector<ShardResult>& results = record.results;
  for (const CampaignState& c : campaigns) {
    results.push_back({c.id, c.status});
    if (c.action == Action::todo) results.back().status = evaluation::Status::none;
    if (c.status != evaluation::Status::failed) continue;
    results.back().errors = c.errors;
    CampaignState stored = c;
    results.back().stored = take_stored(out, run, stored);
  }
  return record;
}

std::string numbers_text(const std::vector<std::uint64_t>& numbers) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, numbers.size()); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
  return text +
         (numbers.size() > most ? " and " + std::to_string(numbers.size() - most) + " more" : "");
}

/// Repeats `try_it` until it succeeds, a stop is requested or `until` has passed, because files of
/// another host may appear late on a shared file system. Returns the last result.
template <class Try>
auto with_patience(std::chrono::steady_clock::time_point until, const Try& try_it) {
  for (;;) {
    auto got = try_it();
    if (got || process::is_stop_requested() || std::chrono::steady_clock::now() >= until)
      return got;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

/// Sets the outcomes of a shard that was evaluated before.
void take_reported(const ShardRecord& record, std::vector<CampaignState>& campaigns) {
  for (std::size_t i = 0; i < campaigns.size() && i < record.results.size(); ++i) {
    const ShardResult& r = record.results[i];
    if (r.status == evaluation::Status::none) continue;
    campaigns[i].action = Action::done;
    campaigns[i].status = r.status;
    campaigns[i].errors = r.errors;
  }
}

/// The campaigns of the shard are the first `own` of `run.campaigns`. After an error with an empty
/// `run.error`, the shard was refused or interrupted.
Expected<void> do_part(const RunOptions& options, const RunEvents& events, const RunPlan& plan,
                       std::size_t own, RunResult& run) {
  RunOptions where = options;
  std::optional<PackedShard> packed;
  if (options.pack) {
    if (const auto record = reported_pack(options.out, plan, options.shard)) {
      run.campaigns.resize(own);
      take_reported(*record, run.campaigns);
      events.planned(own, 0);
      return {};
    }
    NONIO_TRY(auto begun, PackedShard::begin(options, run.campaigns));
    packed.emplace(std::move(begun));
    where.out = packed->out();
  }
  std::size_t to_do = own;
  for (std::size_t i = 0; i < own && !packed; ++i)
    if (take_stored(options.out, plan.run.number, run.campaigns[i])) --to_do;
  events.planned(own, to_do);
  if (to_do > 0) {  // no plugin is loaded if there is nothing to do
    NONIO_TRY(const auto place, set_up(options));
    const reading::Context& read = place->context;
    if (events.words) events.words(config::TerminalWords(read.templates, read.site.language));
    if (const auto same = check_made_with(plan, place->context); !same) return same;
    RunState state;
    state.number = plan.run.number;
    state.date = plan.run.date;
    ReleaseDesk desk;
    desk.plugins = &*place->host;
    desk.elsewhere = true;
    if (!do_campaigns(where, events, place->context, state, desk, run.campaigns)) return fail("");
  }
  run.campaigns.resize(own);
  run.error = "not reported";
  ShardRecord record = record_of(where.out, plan.run.number, run.campaigns);
  if (packed)
    if (auto handed = packed->hand_over(options, plan, record); !handed) return handed;
  if (auto written = write_shard_record(options.out, plan, options.shard, record); !written)
    return written;
  run.error.clear();
  return {};
}

}  // namespace

RunResult run_shard(const RunOptions& options, const RunEvents& events) {
  RunResult run;
  const auto refuse = [&](std::string why) {
    run.end = process::is_stop_requested() ? RunResult::End::interrupted : RunResult::End::refused;
    run.error = std::move(why);
    return std::move(run);
  };
  const auto lock = OutputLock::take(options.out, OutputLock::Use::shard);
  if (!lock) return refuse(lock.error().message);
  const auto plan = read_plan(options.out);
  if (!plan) return refuse(plan.error().message);
  run.run = plan->run;
  if (plan->shards.size() != options.shards)
    return refuse("run " + std::to_string(plan->run.number) + " is planned for " +
                  std::to_string(plan->shards.size()) + " shards; expected --shard i/" +
                  std::to_string(plan->shards.size()) + ", found " + std::to_string(options.shard) +
                  "/" + std::to_string(options.shards));
  auto listed = read_shard_list(options.out, *plan, options.shard);
  if (!listed) return refuse(listed.error().message);
  const std::size_t own = listed->size();
  run.campaigns = states_of(std::move(*listed), false);
  storage::take_own_names(own_token());
  if (const auto done = do_part(options, events, *plan, own, run); !done) {
    if (run.error.empty()) return refuse(done.error().message);
    run.error = done.error().message + "; run the shard again";
  }
  return run;
}

namespace {

/// Unpacks the results that this run has stored in a pack.
Expected<void> take_in_of(const fs::path& out, std::uint64_t run, const std::string& id) {
  const auto record = evaluation::read_record(storage::results_folder(out, id));
  if (!record || record->run != run) return {};
  return evaluation::take_in(out, id);
}

}  // namespace

Expected<void> plan_shards(const RunOptions& options, const reading::Context& context,
                           const RunState& state, bool register_read, std::size_t own_notes,
                           RunResult& run) {
  const bool any = std::any_of(run.campaigns.begin(), run.campaigns.end(),
                               [](const CampaignState& c) { return c.action == Action::todo; });
  if (auto removed = remove_plan(options.out); !removed) return removed;
  if (auto swept = storage::sweep_packs(options.out); !swept) return swept;
  if (state.resumed)  // removes temporary files of an interrupted run or plan
    if (auto tidied = tidy_all(run, options.out, true); !tidied) return tidied;
  for (const CampaignState& c : run.campaigns) {
    if (!state.resumed || c.action != Action::todo || !c.is_campaign) continue;
    // The shard would otherwise use results that this run stored before it was planned again.
    if (auto taken = take_in_of(options.out, state.number, c.id); !taken) return taken;
    const fs::path folder = storage::own_folder(options.out, c.id);
    const auto record = evaluation::read_record(folder);
    if (!record || record->run != state.number) continue;
    if (auto aside = storage::rename_file(folder / evaluation::record_name,
                                          folder / evaluation::record_before_name);
        !aside)
      return fail("cannot put aside " + (folder / evaluation::record_name).string() + ": " +
                  aside.error().message);
  }
  HistoryUpdate history(options, context);
  if (auto begun = history.begin(); !begun) return begun;
  if (any)
    if (const auto begun = ShownHistories(options, context).begin(); !begun) return begun;
  RunPlan plan;
  plan.run = state.of();
  plan.site = state.site;
  plan.made_with = reading::shared_inputs(context);
  plan.register_read = register_read;
  plan.history_known = history.known();
  plan.notes.assign(run.notes.begin() + static_cast<std::ptrdiff_t>(own_notes), run.notes.end());
  plan.vanished = run.vanished;
  plan.shards.resize(options.shards);
  if (process::is_stop_requested()) return fail("");
  if (auto written = write_plan(options.out, plan, run.campaigns); !written) return written;
  for (const RunPlan::List& list : plan.shards) run.planned.push_back(list.campaigns);
  return {};
}

namespace {

bool is_of(const std::vector<ShardResult>& record, const std::vector<Listed>& list) {
  return std::equal(
      record.begin(), record.end(), list.begin(), list.end(),
      [](const ShardResult& r, const Listed& l) { return r.campaign == l.campaign.id; });
}

struct Reported {
  std::vector<Listed> listed;
  ShardRecord record;
};

using Until = std::chrono::steady_clock::time_point;

/// Returns std::nullopt if the record does not exist or its pack is damaged; `why` is the error, if
/// any.
std::optional<ShardRecord> sound_record(const fs::path& out, const RunPlan& plan,
                                        std::uint64_t shard, std::string& why) {
  auto record = read_shard_record(out, plan, shard);
  if (!record) why = record.error().message;
  if (!record || !*record) return std::nullopt;
  if ((*record)->pack)
    if (const auto sound = storage::check_handed_over(out, *(*record)->pack); !sound) {
      why = sound.error().message;
      return std::nullopt;
    }
  return std::move(*record);
}

Expected<std::vector<Reported>> reported_by_all(const fs::path& out, const RunPlan& plan,
                                                Until until) {
  std::vector<Reported> all;
  std::vector<std::uint64_t> silent;
  std::string why;
  for (std::uint64_t shard = 0; shard < plan.shards.size(); ++shard) {
    NONIO_TRY(auto listed, read_shard_list(out, plan, shard));
    auto record = with_patience(until, [&] { return sound_record(out, plan, shard, why); });
    if (process::is_stop_requested()) return fail("");
    if (!record || !is_of(record->results, listed))
      silent.push_back(shard);
    else
      all.push_back({std::move(listed), std::move(*record)});
  }
  if (silent.empty()) return all;
  return fail(std::string("not complete: ") + (silent.size() == 1 ? "shard " : "shards ") +
              numbers_text(silent) + " of " + std::to_string(plan.shards.size()) +
              (silent.size() == 1 ? " has" : " have") + " not reported" +
              (why.empty() ? "" : " (" + why + ")") + "; run `nonio run SITE --out OUT --shard " +
              std::to_string(silent.front()) + "/" + std::to_string(plan.shards.size()) +
              "`, and so on, then `nonio run merge OUT` again");
}

/// Sets the outcome of each campaign of a shard. Campaigns without the stored results that the
/// record states are added to `missing`.
void take_results(const fs::path& out, const RunPlan& plan, std::uint64_t shard, Until until,
                  Reported& reported, std::vector<std::string>& missing) {
  for (std::size_t i = 0; i < reported.listed.size(); ++i) {
    CampaignState& c = reported.listed[i].campaign;
    const ShardResult& result = reported.record.results[i];
    const bool left = result.status == evaluation::Status::none;
    const bool stored = with_patience(left || !result.stored ? Until{} : until,
                                      [&] { return take_stored(out, plan.run.number, c); });
    if (stored || left) continue;
    if (result.stored) missing.push_back(c.id + " (shard " + std::to_string(shard) + ")");
    c.action = Action::done;
    c.status = result.status;
    c.errors = result.errors;
  }
}

}  // namespace

Expected<void> gather(const RunOptions& options, const RunPlan& plan, RunResult& run) {
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                         std::chrono::duration<double>(options.patience));
  NONIO_TRY(auto all, read_rest(options.out, plan));
  for (Listed& one : all) {  // results of an interrupted merge are used
    CampaignState& c = one.campaign;
    if (c.action == Action::todo && c.status != evaluation::Status::failed)
      take_stored(options.out, plan.run.number, c);
  }
  NONIO_TRY(auto reported, reported_by_all(options.out, plan, until));
  std::vector<const ShardRecord*> records;
  for (const Reported& r : reported) records.push_back(&r.record);
  if (auto accepted = accept_packs(options.out, plan, records); !accepted) return accepted;
  std::vector<std::string> missing;
  for (std::uint64_t shard = 0; shard < reported.size(); ++shard) {
    Reported& one = reported[shard];
    take_results(options.out, plan, shard, until, one, missing);
    if (process::is_stop_requested()) return fail("");
    std::move(one.listed.begin(), one.listed.end(), std::back_inserter(all));
    one = {};
  }
  if (!missing.empty())
    return fail("not complete: the results of " + missing.front() +
                (missing.size() == 1 ? " are"
                                     : " and " + std::to_string(missing.size() - 1) + " more are") +
                " not in the output folder; run their shards again, then `nonio run merge OUT`");
  run.campaigns = states_of(std::move(all), true);
  run.vanished = plan.vanished;
  run.notes.insert(run.notes.end(), plan.notes.begin(), plan.notes.end());
  return {};
}

Expected<void> note_failures(const RunOptions& options, const reading::Context& context,
                             const RunResult& run, bool can_sign) {
  std::vector<const CampaignState*> failed;
  for (const CampaignState& c : run.campaigns)
    if (c.action == Action::done && c.is_campaign && c.status == evaluation::Status::failed &&
        !c.errors.empty())
      failed.push_back(&c);
  if (failed.empty()) return {};
  const auto noted =
      read_apart<bool>("the register of certificates", context.site.limits.disk_seconds,
                       [&](process::SignsOfLife& signs) {
                         const certificates::Numbers numbers(
                             {options.site, options.out, run.run.date, can_sign}, context, nullptr);
                         for (const CampaignState* c : failed) {
                           numbers.note_failure(c->id, c->errors.front().message);
                           signs.beat();
                         }
                         return Expected<bool>(true);
                       });
  if (!noted) return fail(noted.error());
  return {};
}

}  // namespace nonio::batch
