// SPDX-License-Identifier: Apache-2.0
#include "batch/run.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "batch/close/history_update.h"
#include "batch/close/mail.h"
#include "batch/close/shown_histories.h"
#include "batch/close/summary.h"
#include "batch/close/worklist_update.h"
#include "batch/commit/store.h"
#include "batch/shards/packed_shard.h"
#include "batch/shards/parts.h"
#include "batch/state/output_lock.h"
#include "batch/state/read_apart.h"
#include "batch/state/run_plan.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/survey/earlier_results.h"
#include "batch/survey/survey.h"
#include "batch/workers/runner.h"
#include "batch/workers/set_up.h"
#include "campaign/reading/context.h"
#include "platform/storage/database.h"
#include "platform/storage/disk.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

namespace fs = std::filesystem;
using Action = CampaignState::Action;

/// Marks the campaign with the folder or id `options.only` for evaluation and restores the outcome
/// of all others from their records. Returns its id. An error unless exactly one campaign matches.
Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run) {
  std::error_code error;
  std::string below = fs::path(options.only).lexically_normal().generic_string();
  while (below.ends_with('/')) below.pop_back();
  const std::string from_here = fs::weakly_canonical(options.only, error)
                                    .lexically_relative(fs::weakly_canonical(options.site, error))
                                    .generic_string();
  std::size_t found = 0;
  std::string one;
  for (CampaignState& c : run.campaigns) {
    const std::string folder = fs::path(c.folder).generic_string();
    const bool is_one =
        c.is_campaign && (c.id == options.only || folder == below || folder == from_here);
    if (is_one) ++found, one = c.id;
    if (is_one && c.action != Action::todo) {
      c.action = Action::todo;
      c.status = evaluation::Status::none;
      c.errors = {};
      c.reason = "--only";
    }
    if (is_one || c.action != Action::todo) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool last_run = record && record->run == state.number;
    c.action = last_run ? Action::done : Action::unchanged;
    c.status = record ? record->status : evaluation::Status::none;
    c.errors = record ? record->errors : std::vector<Error>{};
    c.reason = last_run ? record->reason : "nothing changed";
  }
  if (found == 1) return one;
  return fail("--only: there is " + std::string(found == 0 ? "no" : "more than one") +
              " campaign with the folder or id \"" + options.only + "\" in this site");
}

/// Removes campaigns that were added to the site after the reopened run; the next run evaluates
/// them.
void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns) {
  if (!state.reopened) return;
  std::erase_if(campaigns, [](const CampaignState& c) {
    return c.action != Action::todo && c.status == evaluation::Status::none;
  });
}

/// Stores failed results of campaigns that the survey rejected, but keeps good results of an
/// earlier run. Of several campaigns with the same id only the first is stored, because they share
/// a folder.
void store_refused(const RunOptions& options, const reading::Context& context, const RunState& run,
                   const RunEvents& events, std::vector<CampaignState>& campaigns) {
  const storage::Disk disk(options.out);
  const CampaignState* before = nullptr;
  for (CampaignState& c : campaigns) {
    if (c.action != Action::todo || c.status != evaluation::Status::failed) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool stays = c.is_campaign && record && record->status != evaluation::Status::failed;
    std::vector<Error> errors = c.errors;
    if (stays)
      errors.front().message +=
          "; the results of run " + std::to_string(record->run) + " stay as they are";
    if (c.is_campaign && !stays && (before == nullptr || before->id != c.id)) {
      evaluation::Evaluated evaluated;
      evaluated.campaign.id = c.id;
      evaluated.status = evaluation::Status::failed;
      evaluated.results.errors = errors;
      if (const auto stored =
              store(options.out, evaluated, context, {c.folder, run.of(), c.reason, true}, disk);
          !stored)
        errors.push_back(stored.error());
    }
    c.errors = std::move(errors);
    before = &c;
    c.action = Action::done;
    events.finished(c);
  }
}

bool is_todo(const CampaignState& c) { return c.action == Action::todo; }

/// Returns an error message, or an empty string. The site itself is refused, and any folder in a
/// campaign, because results could replace files of the campaign.
std::string unfit_output(const fs::path& site, const fs::path& out) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(site, error);
  fs::path folder = fs::weakly_canonical(out, error);
  if (folder == root) return "the output folder is the site itself; expected another folder";
  for (; folder != folder.parent_path(); folder = folder.parent_path())
    if (fs::exists(folder / config::manifest_name, error))
      return "the output folder is inside the campaign " + folder.string() +
             "; expected another folder";
  return {};
}

/// Checks the site and the output folder in a child process, because a disk may hang. Returns the
/// canonical path of the site.
Expected<std::string> look_at_site(const RunOptions& options) {
  const fs::path& site = options.site;
  return read_apart<std::string>("the site " + site.string(), config::Limits{}.disk_seconds,
                                 [&](process::SignsOfLife& signs) -> Expected<std::string> {
                                   signs.reading(site.string());
                                   std::error_code error;
                                   if (!fs::is_directory(site, error))
                                     return fail("there is no site folder " + site.string());
                                   if (std::string why = unfit_output(site, options.out);
                                       !why.empty())
                                     return fail(std::move(why));
                                   return fs::weakly_canonical(site, error).string();
                                 });
}

/// Lists the certificates issued since the previous run and the drafts of this run. A locked
/// register is noted, and the next run lists them. Any other error of the register ends the run,
/// because the summary would wrongly state that nothing was issued.
Expected<void> note_certificates(RunResult& run, const RunOptions& options,
                                 const reading::Context& context, RunState& state) {
  NONIO_TRY(auto known, known_of(options, context, Look::again));
  if (!known) {
    run.notes.push_back("the register of certificates is locked: what was issued is not listed");
    return {};
  }
  const std::uint64_t before = state.issued_before.value_or(0);
  state.issued_at_begin = before;
  state.issued_before = issued_so_far(known->numbers);
  for (certificates::RegisterEntry& e : known->numbers) {
    if (!e.in_force()) run.out_of_force.insert(e.number);
    if (e.order > before) run.issued.push_back(std::move(e));
  }
  for (certificates::WaitingDraft& draft : known->drafts) {
    const auto here = std::find_if(run.campaigns.begin(), run.campaigns.end(),
                                   [&](const CampaignState& c) { return c.id == draft.campaign; });
    if (here != run.campaigns.end() && here->status != evaluation::Status::failed)
      run.waiting.push_back(std::move(draft));
  }
  return {};
}

bool is_campaign(const Vanished& v) { return config::is_campaign_id(v.id); }

void leave_out_forgotten(RunResult& run, const Expected<store::SiteRecords>& records) {
  if (!records) return;
  std::erase_if(run.vanished, [&](const Vanished& v) {
    return is_campaign(v) &&
           std::any_of(records->logs.forgotten.begin(), records->logs.forgotten.end(),
                       [&](const config::Forgotten& f) { return f.campaign == v.id; });
  });
}

/// An error is noted in the summary without ending the run; the next run makes the worklist from
/// the results.
WorklistPages worklist_of(RunResult& run, const RunOptions& options, const RunEvents& events,
                          const reading::Context& context) {
  auto made = make_worklist(options, context, last_run_of(run, options.out, context.templates));
  if (made) {
    run.asking = made->asking;
    run.actions = made->actions;
    return std::move(*made);
  }
  if (process::is_stop_requested()) return {};
  run.worklist_error = "the pages of the worklist were not made: " + made.error().message;
  run.notes.push_back(run.worklist_error + "; the next run makes them");
  events.note(run.notes.back());
  return {};
}

/// Sends the mail, unless its text is empty. An error is noted in the summary.
void write_mail(RunResult& run, const RunOptions& options, const RunEvents& events,
                const reading::Context& context, const WorklistPages& worklist) {
  if (worklist.mail.empty() || process::is_stop_requested()) return;
  const config::TerminalWords words(context.templates, context.site.language);
  const std::string subject =
      words("mail.subject", {{"number", std::to_string(run.run.number)}, {"date", run.run.date}});
  const auto sent = send_mail(*context.site.mail, options.site, {subject, worklist.mail});
  if (sent) return;
  run.worklist_error = "the mail of this run was not sent: " + sent.error().message;
  run.notes.push_back(run.worklist_error);
  events.note(run.notes.back());
}

constexpr const char* webhook_failed = "webhook-failed";

/// Sends new lines that require action once; OUT/.nonio/webhook.json contains the ids of accepted
/// lines. After an error, the next run sends them again, and its summary states the error.
void post_news(const RunResult& run, const RunOptions& options, const RunEvents& events,
               const reading::Context& context) {
  using storage::Json;
  constexpr const char* name = "webhook.json";
  const Json actions = storage::parse_or_discard(run.actions);
  if (!context.site.webhook || !actions.is_array() || process::is_stop_requested()) return;
  const std::filesystem::path folder = options.out / state_folder;
  const auto before = storage::read_file(folder / name);
  const Json taken = before ? storage::parse_or_discard(*before) : Json::array();
  Json lines = Json::array(), ids = Json::array(), still = Json::array();
  for (const Json& line : actions) {
    const bool known = std::find(taken.begin(), taken.end(), line.at("id")) != taken.end();
    (known ? still : lines).push_back(known ? line.at("id") : line);
    ids.push_back(line.at("id"));
  }
  if (!lines.empty()) {
    const Json body = {{"schema", "nonio-webhook/1"},
                       {"run", run.run.number},
                       {"date", run.run.date},
                       {"lines", lines}};
    if (const auto sent = send_webhook(*context.site.webhook, options.site, storage::dump(body));
        !sent) {
      const std::string why = "the webhook did not take " + std::to_string(lines.size()) +
                              " lines after run " + std::to_string(run.run.number) + ": " +
                              sent.error().message;
      events.note(why + "; the next run sends them again");
      if (auto kept = storage::publish(folder, {{webhook_failed, why}}); !kept)
        events.note(kept.error().message);
      ids = still;
    } else {
      std::error_code none;
      fs::remove(folder / webhook_failed, none);
    }
  }
  if (ids == taken) return;
  if (auto kept = storage::publish(folder, {{name, storage::dump(ids)}}); !kept)
    events.note(kept.error().message);
}

/// A reopened run sends neither mail nor webhook. The webhook is called last, because the run has
/// ended then.
Expected<void> close_run(RunResult& run, const RunOptions& options, const RunEvents& events,
                         const SetUp& place, RunState& state) {
  const reading::Context& context = place.context;
  if (auto tidied = tidy_all(run, options.out, state.resumed); !tidied) return tidied;
  if (auto noted = note_certificates(run, options, context, state); !noted) return noted;
  const WorklistPages worklist = worklist_of(run, options, events, context);
  if (!state.reopened) write_mail(run, options, events, context, worklist);
  if (const auto failed = storage::read_small_file(options.out / state_folder / webhook_failed))
    run.notes.push_back(*failed + "; they are sent again after this run");
  const config::TerminalWords words(context.templates, context.site.language);
  if (auto written = write_summary(run, options.out, options.version, words, worklist); !written)
    return written;
  if (auto kept = place.parts.keep(state.of()); !kept) return kept;
  auto ended = end_run(options.out, state, {state.of(), run.campaigns.size(), run.failed()});
  if (ended && !state.reopened) post_news(run, options, events, context);
  return ended;
}

/// Reports at most 100 missing campaigns and parts of the site; summary.json lists all.
void tell_vanished(const RunResult& run, const RunEvents& events) {
  constexpr std::size_t most = 100;
  for (std::size_t i = 0; i < std::min(most, run.vanished.size()); ++i) {
    const Vanished& v = run.vanished[i];
    events.note(is_campaign(v) ? "campaign " + v.id + " has vanished: " + v.why
                               : v.id + " " + v.why);
  }
  if (run.vanished.size() > most)
    events.note("and " + std::to_string(run.vanished.size() - most) +
                " more have vanished: see the summary");
}

Expected<void> survey_site(const RunOptions& options, const reading::Context& context,
                           const RunState& state, const std::optional<Known>& known,
                           RunResult& run) {
  SurveyInput input{options.site,
                    options.out,
                    context,
                    state.number,
                    state.force,
                    std::nullopt,
                    {},
                    run.notes,
                    process::is_stop_requested,
                    options.verify_results};
  if (known) {
    input.numbers = known->numbers;
    for (const certificates::WaitingDraft& draft : known->drafts)
      input.drafts.insert(draft.campaign);
  }
  NONIO_TRY(auto surveyed, survey(input));
  run.campaigns = std::move(surveyed.campaigns);
  run.vanished = std::move(surveyed.vanished);
  run.may_vanish = context.site.limits.missing_campaigns;
  return {};
}

void report_former_keys(const RunResult& run, const RunEvents& events) {
  constexpr std::size_t most = 20;
  std::size_t count = 0;
  for (const CampaignState& c : run.campaigns)
    for (const Error& w : c.warnings)
      if (++count <= most)
        events.note(storage::path_text(c.folder) + "/" + w.file + ":" + std::to_string(w.line) +
                    ": " + w.message);
  if (count > most)
    events.note("and " + std::to_string(count - most) +
                " more keys with former names: `nonio check` lists them");
}

void tell_plan(const RunResult& run, const RunEvents& events) {
  tell_vanished(run, events);
  report_former_keys(run, events);
  events.planned(run.campaigns.size(), static_cast<std::size_t>(std::count_if(
                                           run.campaigns.begin(), run.campaigns.end(), is_todo)));
}

/// Data that are available before the first evaluation.
struct Plan {
  Expected<store::SiteRecords> records;
  /// Id of the campaign of a reopened run, otherwise empty.
  std::string only;
  /// Last run that the store contained completely, according to the plan of a run in shards.
  std::optional<std::uint64_t> history_known{};
};

/// An error ends the run; its message is empty if a stop was requested.
Expected<Plan> plan_run(const RunOptions& options, const RunEvents& events, const SetUp& place,
                        const RunState& state, const std::optional<Known>& known, RunResult& run) {
  const reading::Context& context = place.context;
  const std::size_t notes_so_far = run.notes.size();
  const auto surveyed = survey_site(options, context, state, known, run);
  if (process::is_stop_requested()) return fail("");
  if (!surveyed) return fail(surveyed.error());
  std::string only;
  if (state.reopened) {
    NONIO_TRY(auto one, leave_only(options, state, run));
    only = std::move(one);
  }
  const auto& lost = place.parts.lost();
  run.vanished.insert(run.vanished.end(), lost.begin(), lost.end());
  Plan plan{read_records(options, context), std::move(only)};
  leave_out_forgotten(run, plan.records);
  for (std::size_t i = notes_so_far; i < run.notes.size(); ++i) events.note(run.notes[i]);
  tell_plan(run, events);
  return plan;
}

void tell_stage(const RunEvents& events, const char* name) {
  if (events.stage) events.stage(name);
}

/// Continues a run in shards after their results were gathered in `run`. Checks the certificate
/// numbers if the plan was made without the register, and enters failures into the register.
Expected<Plan> planned_run_of(const RunOptions& options, const RunEvents& events,
                              const SetUp& place, const RunPlan& planned,
                              const std::optional<Known>& known, RunResult& run) {
  const reading::Context& context = place.context;
  run.may_vanish = context.site.limits.missing_campaigns;
  if (!planned.register_read && known)
    if (auto fit = check_numbers(options.out, run.campaigns, known->numbers); !fit)
      return fail(fit.error());
  if (auto noted = note_failures(options, context, run, place.signer.has_value()); !noted)
    return fail(noted.error());
  Plan plan{read_records(options, context), {}, planned.history_known};
  leave_out_forgotten(run, plan.records);
  tell_plan(run, events);
  return plan;
}

/// Evaluates the planned campaigns, then updates the history and the reports that contain it. An
/// error ends the run; its message is empty if a stop was requested.
Expected<void> do_planned(const RunOptions& options, const RunEvents& events, SetUp& place,
                          const Plan& plan, bool register_known, RunState& state, RunResult& run) {
  const reading::Context& context = place.context;
  tell_stage(events, "campaigns");
  HistoryUpdate history(options, context);
  if (const auto begun = history.begin(plan.history_known); !begun) return begun;
  if (std::any_of(run.campaigns.begin(), run.campaigns.end(), is_todo))
    if (const auto begun = ShownHistories(options, context).begin(); !begun) return begun;
  store_refused(options, context, state, events, run.campaigns);
  ReleaseDesk desk;
  desk.signer = place.signer ? &*place.signer : nullptr;
  desk.plugins = &*place.host;
  if (!register_known)
    desk.recheck = [&](const std::vector<certificates::RegisterEntry>& numbers) {
      if (!state.issued_before) state.issued_before = issued_so_far(numbers);
      return check_numbers(options.out, run.campaigns, numbers);
    };
  // One job at the merge, so that certificates are numbered in the order of the ids.
  RunOptions numbered = options;
  if (options.step == RunOptions::Step::merge && context.site.numbering.automatic)
    numbered.jobs = 1;
  bool well = do_campaigns(numbered, events, context, state, desk, run.campaigns);
  if (well && !process::is_stop_requested()) {
    std::vector<std::string> done;
    for (const CampaignState& c : run.campaigns)
      if (c.action == Action::done && c.is_campaign) done.push_back(c.id);
    tell_stage(events, "history");
    const std::uint64_t before = state.reopened ? state.number
                                 : state.last   ? state.last->run.number
                                                : 0;
    write_history(run, history, before, done, plan.records, events);
    well = show_histories(options, events, context, state, desk, history, plan.records, plan.only,
                          run);
  }
  if (well) return {};
  if (state.reopened && std::any_of(run.campaigns.begin(), run.campaigns.end(), is_todo))
    history.nothing_done();
  tidy_root(options.out);
  return fail("");
}

/// Checks the layout of the results folders and the catalogue of packs before results are read, and
/// accepts the packs of a plan that is replaced.
Expected<void> make_ready(const RunOptions& options, const reading::Context& context) {
  auto ready = settle_folders(options.out, context.site.hashed_folders, options.dry_run);
  if (ready) ready = storage::check_catalogue(options.out);
  if (ready && options.step == RunOptions::Step::plan) ready = keep_packs(options.out);
  return ready;
}

/// The caller has locked the output folder. The outcome is stored in `run`.
void do_run(const RunOptions& options, const RunEvents& events, const std::string& site_text,
            SetUp& place, const std::optional<Known>& known, RunResult& run) {
  const reading::Context& context = place.context;
  const auto refuse = [&](std::string why) {
    run.end = process::is_stop_requested() || why.empty() ? RunResult::End::interrupted
                                                          : RunResult::End::refused;
    run.error = std::move(why);
  };
  if (const auto ready = make_ready(options, context); !ready) return refuse(ready.error().message);
  std::optional<RunPlan> planned;
  if (options.step == RunOptions::Step::merge) {
    auto read = read_plan(options.out);
    if (!read) return refuse(read.error().message);
    planned = std::move(*read);
  }
  auto state = planned ? planned_run(options, site_text, planned->run.number)
               : !options.only.empty()
                   ? reopen_run(options, site_text)
                   : begin_run(options, site_text,
                               known ? std::optional(issued_so_far(known->numbers)) : std::nullopt);
  if (!state) return refuse(state.error().message);
  run.run = state->of();
  if (state->last) run.seen_before = state->last->seen;
  tell_stage(events, "survey");
  const std::size_t own_notes = run.notes.size();
  if (planned) {
    if (auto same = check_made_with(*planned, context); !same) return refuse(same.error().message);
    if (auto gathered = gather(options, *planned, run); !gathered) {
      if (process::is_stop_requested()) return refuse({});
      run.error = gathered.error().message;
      return;
    }
  }
  const auto plan = planned ? planned_run_of(options, events, place, *planned, known, run)
                            : plan_run(options, events, place, *state, known, run);
  if (!plan) return refuse(plan.error().message);
  if (options.dry_run) return;
  if (options.step == RunOptions::Step::plan) {
    const auto written = plan_shards(options, context, *state, known.has_value(), own_notes, run);
    if (!written) refuse(written.error().message);
    return;
  }
  if (const auto done = do_planned(options, events, place, *plan, known.has_value(), *state, run);
      !done)
    return refuse(done.error().message);
  leave_out_new(*state, run.campaigns);
  tell_stage(events, "pages");
  const auto closed = close_run(run, options, events, place, *state);
  if (closed && planned) {
    auto gone = remove_plan(options.out);
    if (gone) gone = storage::sweep_packs(options.out);
    if (!gone) run.error = gone.error().message;
  }
  if (closed) return;
  tidy_root(options.out);
  if (process::is_stop_requested()) return refuse({});
  run.error = closed.error().message + "; the same command goes on where it stopped";
}

/// Ends the processes of a run. Its memory goes with this process, because freeing all texts of the
/// templates one by one takes as long as reading them.
void leave(std::unique_ptr<SetUp> place) {
  static auto* const left = new std::vector<std::unique_ptr<SetUp>>();
  place->host.reset();
  place->signer.reset();
  left->push_back(std::move(place));
}

}  // namespace

RunResult run_site(const RunOptions& options, const RunEvents& events) {
  RunResult run;
  const auto refuse = [&](std::string why) {
    run.end = process::is_stop_requested() ? RunResult::End::interrupted : RunResult::End::refused;
    run.error = std::move(why);
    return std::move(run);
  };
  const auto site_text = look_at_site(options);
  if (!site_text) return refuse(site_text.error().message);
  auto place = set_up(options);
  if (!place) return refuse(place.error().message);
  const reading::Context& context = (*place)->context;
  run.notes = (*place)->notes;
  if (events.words) events.words(config::TerminalWords(context.templates, context.site.language));

  std::optional<OutputLock> lock;
  if (options.dry_run) {
    if (const auto free = check_not_planned(options.out); !free)
      return refuse(free.error().message);
  } else {
    const bool whole = options.step == RunOptions::Step::whole;
    auto taken =
        OutputLock::take(options.out, whole ? OutputLock::Use::whole : OutputLock::Use::planned);
    if (!taken) return refuse(taken.error().message);
    lock.emplace(std::move(*taken));
  }
  const auto known = known_of(options, context);
  if (!known) return refuse(known.error().message);
  if (!*known)
    run.notes.push_back(
        "another process keeps the register of certificates locked, or its server is away: "
        "campaigns that need a number wait for it");
  for (const std::string& note : run.notes) events.note(note);
  if (!(*place)->unstamped.empty()) run.notes.push_back((*place)->unstamped);
  // Memory that is released if none is left, so that the error can be reported.
  auto reserve = std::make_unique<std::array<char, 1 << 18>>();
  try {
    do_run(options, events, *site_text, **place, *known, run);
  } catch (const std::exception& e) {
    reserve.reset();
    run.error = dynamic_cast<const std::bad_alloc*>(&e) != nullptr
                    ? "out of memory; the same command goes on where it stopped"
                    : e.what();
    if (lock) [[maybe_unused]]
      const auto tidied = tidy_all(run, options.out, true);
  }
  leave(std::move(*place));
  return run;
}

}  // namespace nonio::batch
