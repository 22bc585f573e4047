// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/run.h"

#include <Poco/Environment.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <ctime>
#include <iostream>

#include "certificates.h"
#include "committer.h"
#include "context.h"
#include "night_state.h"
#include "nonio/host/files.h"
#include "nonio/host/results_json.h"
#include "numbering.h"
#include "signer.h"
#include "store.h"
#include "summary.h"
#include "survey.h"
#include "worker.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

using Action = CampaignState::Action;

std::atomic<bool> stop_requested = false;  // set by a signal
static_assert(std::atomic<bool>::is_always_lock_free);

/// Memory that a worker gives back to the system is only faulted in again for the next campaign.
void keep_freed_memory() {
  constexpr int megabyte = 1 << 20;
  ::mallopt(M_MMAP_THRESHOLD, 32 * megabyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * megabyte);
  ::mallopt(M_TOP_PAD, megabyte);
}

/// A worker is replaced after so many campaigns: starting one is then cheap, and what plugins may
/// leave behind in it does not grow old. Plugins from elsewhere than beside the program were not
/// tested with it: one of them, and every campaign gets a process of its own.
constexpr std::size_t campaigns_per_worker = 64;

std::string day_of(std::time_t time) {
  std::tm local{};
  ::localtime_r(&time, &local);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &local)};
}

class Runner {
 public:
  Runner(const RunOptions& options, const RunEvents& events, const Context& context,
         const NightState& night, Signer* signer, std::vector<CampaignState>& campaigns)
      : options_(options),
        events_(events),
        context_(context),
        night_(night),
        signer_(signer),
        numbers_(options.site, context, day_of(std::time(nullptr)), signer != nullptr),
        campaigns_(campaigns),
        committer_([this](const std::vector<std::size_t>& batch) {
          std::vector<std::string> ids;
          for (const std::size_t c : batch) ids.push_back(campaigns_[c].id);
          return commit(options_.out, ids, night_.number);
        }),
        campaigns_per_worker_(context.plugins->all_from(options.own_plugins) ? campaigns_per_worker
                                                                             : 1) {}

  /// False if it was interrupted.
  bool run() {
    keep_freed_memory();
    prepare_outputs();
    const std::size_t jobs =
        options_.jobs != 0 ? options_.jobs : Poco::Environment::processorCount();
    while (!stop_requested) {
      while (workers_.size() < jobs && !stop_requested) {
        const auto campaign = next();
        if (!campaign) break;
        start(*campaign);
      }
      if (workers_.empty() && committer_.pending().empty()) return true;
      wait();
    }
    stop();
    return false;
  }

 private:
  /// In a child first: what does not come back there is not called here.
  void prepare_outputs() const {
    for (const Output& output : context_.plugins->outputs()) {
      if (output.prepare == nullptr) continue;
      const pid_t child = ::fork();
      if (child == 0) {
        settle_child();
        limit_memory(context_.site.limits.memory_MB);
        output.prepare(context_.templates);
        ::_exit(0);
      }
      const ChildEnd end = child < 0 ? ChildEnd{false, "no process"} : wait_for_child(child, 30.0);
      if (end.well)
        output.prepare(context_.templates);
      else
        events_.note("output " + output.info.name + " could not prepare: " + end.words);
    }
  }

  /// The next campaign to do; those that get a second trial first.
  std::optional<std::size_t> next() {
    if (!again_.empty()) {
      const std::size_t campaign = again_.back();
      again_.pop_back();
      return campaign;
    }
    while (next_ < campaigns_.size() && campaigns_[next_].action != Action::todo) ++next_;
    return next_ < campaigns_.size() ? std::optional(next_++) : std::nullopt;
  }

  void start(std::size_t campaign) {
    auto worker = Worker::start(
        [this](std::size_t c, bool first, SharedWords& stage) { return work(c, first, stage); },
        context_.site.limits.memory_MB);
    if (!worker) return lost(campaign, worker.error().message);
    workers_.push_back(std::move(*worker));
    give(workers_.back(), campaign);
  }

  void give(Worker& worker, std::size_t campaign) const {
    worker.give(campaign, std::chrono::duration_cast<Worker::Clock::duration>(
                              std::chrono::duration<double>(context_.site.limits.seconds)));
  }

  /// What is evaluated is stored, what is not is given up. A disk that does not answer does not
  /// hold up the one who wants to stop.
  void stop() {
    for (Worker& w : workers_) {
      w.end();
      remove_leftovers(options_.out / campaigns_[w.campaign()].id);
    }
    workers_.clear();
    const auto deadline = Worker::Clock::now() + std::chrono::seconds(10);
    while (!committer_.pending().empty() && Worker::Clock::now() < deadline) {
      wait_for_answer(workers_, committer_.channel());
      take_stored();
    }
    for (const std::size_t c : committer_.pending())
      remove_leftovers(options_.out / campaigns_[c].id);
  }

  /// In the worker's process.
  Answer work(std::size_t index, bool first, SharedWords& stage) const {
    if (first && signer_ != nullptr) signer_->leave_to_worker();
    const CampaignState& c = campaigns_[index];
    const fs::path folder = options_.site / c.folder;
    Evaluated evaluated = evaluate(
        folder, c.id, context_, [&](const std::string& s) { stage.set(s); },
        [&](const Evaluated& e, bool complete) { return numbers_.draw(e, folder, complete); });
    stage.set("signing");
    auto certified = sign_artifacts(evaluated, folder, context_, signer_, std::time(nullptr));
    if (certified) certified = numbers_.issue(evaluated);
    if (!certified) fail_certificate(evaluated, certified.error());
    if (evaluated.status == "failed" && !first) return Answer::again;
    if (evaluated.status == "failed" && !evaluated.results.errors.empty())
      numbers_.note_failure(c.id, evaluated.results.errors.front().message);
    stage.set("writing the results");
    const auto staged = host::stage(options_.out, evaluated, context_,
                                    {c.folder, night_.number, c.reason, evaluated.retry});
    if (!staged) {
      stage.set(staged.error().message);
      return Answer::not_stored;
    }
    return evaluated.status == "failed"      ? Answer::failed
           : evaluated.status == "attention" ? Answer::attention
                                             : Answer::ok;
  }

  static void fail_certificate(Evaluated& evaluated, const Error& why) {
    remove_unsigned(evaluated);
    evaluated.results.errors.push_back(why);
    evaluated.status = "failed";
    evaluated.retry = true;
  }

  void wait() {
    if (signer_ != nullptr) signer_->revive();
    wait_for_answer(workers_, committer_.channel());
    take_stored();
    for (std::size_t i = workers_.size(); i-- > 0;) {
      Worker& worker = workers_[i];
      bool goes_on = false;
      if (const auto answer = worker.answer())
        goes_on = take(worker, *answer);
      else if (worker.overdue())
        not_done(worker, "no end within the limit of " +
                             short_number(context_.site.limits.seconds) +
                             " s ([limits] seconds in site.toml)");
      else
        continue;
      if (const auto campaign = goes_on ? next() : std::nullopt)
        give(worker, *campaign);
      else
        workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    events_.tick();
  }

  /// Whether the worker may do another campaign. It may not after one that failed, and it makes
  /// room for a second trial, which is the first campaign of a new worker.
  bool take(Worker& worker, Answer answer) {
    switch (answer) {
      case Answer::ok:
      case Answer::attention:
      case Answer::failed:
        campaigns_[worker.campaign()].status = to_text(answer);
        if (const auto given = committer_.give(worker.campaign()); !given)
          lost(worker.campaign(), given.error().message);
        return answer != Answer::failed && worker.given() < campaigns_per_worker_ &&
               !worker.grown() && again_.empty();
      case Answer::again:
        again_.push_back(worker.campaign());
        return false;
      case Answer::not_stored:
        not_done(worker, worker.stage());
        return false;
      case Answer::none:
        break;
    }
    const std::string stage = worker.stage();
    const ChildEnd end = worker.end();
    not_done(worker, stage + ": " + (end.well ? "ended the process" : end.words));
    return false;
  }

  /// Nobody pays for his predecessors: only what fails in a new process has failed.
  void not_done(Worker& worker, const std::string& why) {
    worker.end();
    if (worker.given() > 1)
      again_.push_back(worker.campaign());
    else
      lost(worker.campaign(), why);
  }

  void take_stored() {
    for (Committer::Done& done : committer_.done()) {
      const CampaignState& c = campaigns_[done.campaign];
      if (done.again) {
        const auto stored = commit(options_.out, {c.id}, night_.number).front();
        done.error = stored ? "" : stored.error().message;
      }
      if (!done.error.empty())
        lost(done.campaign, done.error);
      else if (c.status == "failed")
        take_failed(done.campaign);
      else
        finish(done.campaign, c.status, {});
    }
  }

  void take_failed(std::size_t index) {
    const auto record = read_record(options_.out / campaigns_[index].id);
    if (!record) return lost(index, "its record cannot be read: " + record.error().message);
    finish(index, record->status, record->errors);
  }

  static const char* to_text(Answer answer) {
    return answer == Answer::ok ? "ok" : answer == Answer::attention ? "attention" : "failed";
  }

  static std::string short_number(double x) {
    std::string s = std::to_string(x);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.ends_with('.')) s.pop_back();
    return s;
  }

  /// The worker did not come back with results: the campaign is failed, and says why.
  void lost(std::size_t index, const std::string& why) {
    CampaignState& c = campaigns_[index];
    numbers_.note_failure(c.id, why);
    Evaluated evaluated;
    evaluated.campaign.id = c.id;
    evaluated.status = "failed";
    evaluated.results.errors = {Error{why}};
    const auto stored =
        store(options_.out, evaluated, context_, {c.folder, night_.number, c.reason, true});
    if (!stored) remove_leftovers(options_.out / c.id);
    finish(index, "failed", std::move(evaluated.results.errors));
  }

  void finish(std::size_t index, std::string status, std::vector<Error> errors) {
    CampaignState& c = campaigns_[index];
    c.action = Action::done;
    c.status = std::move(status);
    c.errors = std::move(errors);
    events_.finished(c);
  }

  const RunOptions& options_;
  const RunEvents& events_;
  const Context& context_;
  const NightState& night_;
  Signer* signer_;  ///< null: nobody signs
  const Numbers numbers_;
  std::vector<CampaignState>& campaigns_;
  Committer committer_;
  const std::size_t campaigns_per_worker_;
  std::size_t next_ = 0;
  std::vector<std::size_t> again_;  ///< get a second trial
  std::vector<Worker> workers_;
};

std::string all_of(const std::vector<Error>& errors) {
  std::string text;
  for (const Error& e : errors)
    text += (text.empty() ? "" : "\n") + e.file +
            (e.line != 0 ? ":" + std::to_string(e.line) : "") + (e.file.empty() ? "" : ": ") +
            e.message;
  return text;
}

/// Results are never written among the files of a campaign, which they could replace.
std::string unfit_output(const fs::path& site, const fs::path& out) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(site, error);
  fs::path folder = fs::weakly_canonical(out, error);
  if (folder == root) return "the output folder is the site itself; wanted another folder";
  for (; folder != folder.parent_path(); folder = folder.parent_path())
    if (fs::exists(folder / manifest_name, error))
      return "the output folder lies in the campaign " + folder.string() +
             "; wanted another folder";
  return {};
}

/// Campaigns whose ids collide get a failed result in the one folder that they all claim.
void store_collisions(const RunOptions& options, const Context& context, const NightState& night,
                      std::vector<CampaignState>& campaigns) {
  for (CampaignState& c : campaigns) {
    if (c.action != Action::todo || c.status != "failed") continue;
    Evaluated evaluated;
    evaluated.campaign.id = c.id;
    evaluated.status = "failed";
    evaluated.results.errors = c.errors;
    if (const auto stored =
            store(options.out, evaluated, context, {c.folder, night.number, c.reason, true});
        !stored)
      c.errors.push_back(stored.error());
    c.action = Action::done;
  }
}

/// What the morning's reader should know of the key. What is returned is for the summary alone, not
/// for whoever watches: it is the same every night.
std::string note_key(Signer& signer, bool is_stamped, std::vector<std::string>& notes) {
  constexpr sign::Time month = sign::Time{30} * 86400;
  const auto who = signer.start();
  if (!who)
    notes.push_back("nothing can be signed: " + who.error().message);
  else if (who->not_after - std::time(nullptr) < month)
    notes.push_back("the signing certificate of " + who->subject + " runs out on " +
                    sign::text_of(who->not_after) + ": have a new one made");
  if (!who || is_stamped) return {};
  return "no time-stamp server is named (time_stamp in [signing] of site.toml): what is signed "
         "holds until the certificate of " +
         who->subject + " runs out on " + sign::text_of(who->not_after) + ", and no longer";
}

/// A register in an output folder below the site would be lost with it.
Expected<std::vector<RegisterEntry>> numbers_of(const RunOptions& options, const Context& context) {
  const auto path = register_path(options.site, context.site.numbering);
  if (!path) return fail(path.error());
  std::error_code error;
  const auto is_below = [](const fs::path& one, const fs::path& folder) {
    const fs::path way = one.lexically_relative(folder);
    return !way.empty() && *way.begin() != "..";
  };
  const fs::path out = fs::weakly_canonical(options.out, error);
  if (is_below(*path, out) && is_below(out, fs::weakly_canonical(options.site, error)))
    return fail("the register of certificates " + path->string() +
                " would lie in the output folder; wanted it elsewhere in the site");
  return Register::entries(options.site, context.site.numbering);
}

std::uint64_t issued_so_far(const std::vector<RegisterEntry>& numbers) {
  std::uint64_t last = 0;
  for (const RegisterEntry& e : numbers) last = std::max(last, e.order);
  return last;
}

/// In the order of their numbers.
void note_issued(Night& night, const RunOptions& options, const Context& context,
                 std::uint64_t before) {
  auto numbers = Register::entries(options.site, context.site.numbering);
  if (!numbers) {
    night.notes.push_back(numbers.error().message);
    return;
  }
  for (RegisterEntry& e : *numbers)
    if (e.order > before) night.issued.push_back(std::move(e));
}

}  // namespace

void request_stop() { stop_requested = true; }

Night run_site(const RunOptions& options, const RunEvents& events) {
  Night night;
  const auto refuse = [&](std::string why) {
    night.end = Night::End::refused;
    night.error = std::move(why);
    return night;
  };
  std::error_code error;
  if (!fs::is_directory(options.site, error))
    return refuse("there is no site folder " + options.site.string());
  if (const std::string why = unfit_output(options.site, options.out); !why.empty())
    return refuse(why);
  Context context;
  context.version = options.version;
  auto site = read_site(options.site, context.site_sha256);
  if (!site) return refuse(all_of(site.error()));
  context.site = std::move(*site);
  night.notes = context.site.notes;
  std::optional<Signer> signer;  // before any plugin is in the memory
  std::string unstamped;
  if (context.site.signing && !options.dry_run)
    unstamped = note_key(signer.emplace(*context.site.signing, options.site),
                         !context.site.signing->time_stamp.empty(), night.notes);
  std::vector<fs::path> template_folders = options.template_folders;
  if (fs::is_directory(options.site / "templates", error))
    template_folders.push_back(options.site / "templates");
  auto templates =
      read_templates(template_folders, context.templates_sha256, &context.templates_json);
  if (!templates) return refuse(all_of({templates.error()}));
  context.templates = std::move(*templates);

  Plugins plugins;
  plugins.load(options.plugin_folders);
  if (!plugins.conflicts().empty()) return refuse(plugins.conflicts().front());
  for (std::string& note : plugins.refusal_notes()) night.notes.push_back(std::move(note));
  for (const std::string& note : night.notes) events.note(note);
  if (!unstamped.empty()) night.notes.push_back(std::move(unstamped));
  context.plugins = &plugins;
  context.plugins_sha256 = plugins.digest();
  if (const auto mistakes = site_mistakes(context); !mistakes.empty())
    return refuse(all_of(mistakes));

  std::optional<OutputLock> lock;
  if (!options.dry_run) {
    auto taken = OutputLock::take(options.out);
    if (!taken) return refuse(taken.error().message);
    lock.emplace(std::move(*taken));
  }
  const auto numbers = numbers_of(options, context);
  if (!numbers) return refuse(numbers.error().message);
  const auto state =
      begin_night(options.out, options.force, options.dry_run, issued_so_far(*numbers));
  if (!state) return refuse(state.error().message);
  const std::size_t notes_so_far = night.notes.size();
  auto campaigns = survey({options.site, options.out, context, state->number, state->force,
                           *numbers, night.notes, [] { return stop_requested.load(); }});
  if (stop_requested) {
    night.end = Night::End::interrupted;
    return night;
  }
  if (!campaigns) return refuse(campaigns.error().message);
  night.campaigns = std::move(*campaigns);
  for (std::size_t i = notes_so_far; i < night.notes.size(); ++i) events.note(night.notes[i]);
  const auto is_todo = [](const CampaignState& c) {
    return c.action == Action::todo && c.status.empty();
  };
  events.planned(night.campaigns.size(),
                 static_cast<std::size_t>(
                     std::count_if(night.campaigns.begin(), night.campaigns.end(), is_todo)));
  if (options.dry_run) return night;

  store_collisions(options, context, *state, night.campaigns);
  if (!Runner(options, events, context, *state, signer ? &*signer : nullptr, night.campaigns)
           .run()) {
    night.end = Night::End::interrupted;
    return night;
  }
  note_issued(night, options, context, state->issued_before);
  const auto written = write_summary(night, options.out, options.version);
  // The campaigns are safe; the night stays open, and the next run ends it.
  if (!written)
    night.error = written.error().message;
  else if (const auto ended = end_night(options.out, *state); !ended)
    night.error = ended.error().message;
  return night;
}

}  // namespace nonio::host
