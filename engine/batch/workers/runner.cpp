// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/runner.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <iterator>
#include <map>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "batch/commit/committer.h"
#include "batch/commit/store.h"
#include "batch/state/read_apart.h"
#include "batch/state/run_result.h"
#include "batch/state/run_state.h"
#include "batch/survey/twins.h"
#include "batch/workers/computing.h"
#include "batch/workers/worker.h"
#include "campaign/config/site_files.h"
#include "certificates/certificates.h"
#include "certificates/numbering.h"
#include "certificates/signer.h"
#include "laboratory/assessment/history_so_far.h"
#include "platform/process/child.h"
#include "platform/storage/database.h"
#include "platform/storage/disk.h"
#include "platform/storage/files.h"

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

/// Data of all campaigns of a run, or of the campaign that is approved.
struct SiteWork {
  const RunOptions& options;
  const reading::Context& context;
  const RunState& run;
  const std::vector<CampaignState>& campaigns;
  const certificates::Numbers& numbers;
  certificates::Signer* signer;
  /// Shared files of readings of an approved campaign; null in a run.
  const reading::Twins* twins;
  /// Machine histories by campaign id.
  const std::map<std::string, assessment::HistoryBasis>& histories;
  /// Whether register and key are on another host; campaigns that need them are left to the merge.
  bool elsewhere = false;
};

struct RegisterState {
  bool read = true;         ///< false if another process has locked the register
  std::string unsound{};    ///< reason why no number can be assigned
  bool last_trial = false;  ///< whether a locked register is an error instead of a reason to wait
};
namespace fs = std::filesystem;

constexpr const char* register_elsewhere = "the register of certificates is on another host";
constexpr const char* register_locked =
    "the certificate register has been locked by another process since the run started";

/// Whether the host caused the error: lack of memory, or a disk or share that does not respond.
bool is_of_the_machine(const Error& e) {
  if (e.message.find("out of memory") != e.message.npos) return true;
  constexpr int codes[] = {EIO, ESTALE, ETIMEDOUT, ENOTCONN, EHOSTDOWN, EHOSTUNREACH, ENOMEM};
  return std::any_of(std::begin(codes), std::end(codes),
                     [&](int code) { return e.message.ends_with(std::strerror(code)); });
}
bool is_of_the_machine(const evaluation::Evaluated& evaluated) {
  const auto& errors = evaluated.results.errors;
  return std::any_of(errors.begin(), errors.end(),
                     [](const Error& e) { return is_of_the_machine(e); });
}

void fail_certificate(evaluation::Evaluated& evaluated, const Error& why) {
  certificates::remove_unsigned(evaluated);
  evaluated.results.errors.push_back(why);
  evaluated.status = evaluation::Status::failed;
  evaluated.retry = true;
}

/// The error is set if the register is on another host, damaged or locked. `locked` is set if the
/// register may be available later.
evaluation::AssignedNumber number_of(const SiteWork& site, const RegisterState& state,
                                     const evaluation::Evaluated& evaluated,
                                     const std::vector<std::string>& missing,
                                     certificates::CampaignFiles& files, bool as_draft,
                                     bool& locked) {
  evaluation::AssignedNumber assigned{std::nullopt, missing, std::nullopt};
  if (site.elsewhere) {
    locked = true;
    assigned.error = Error{register_elsewhere};
    return assigned;
  }
  if (!state.unsound.empty()) {
    assigned.error = Error{state.unsound};
  } else if (!state.read) {
    locked = true;
    assigned.error = Error{register_locked};
  } else {
    assigned = site.numbers.assign(evaluated, files, missing, as_draft);
    locked = locked || (assigned.error && storage::is_locked(*assigned.error));
  }
  return assigned;
}

Expected<std::optional<HistorySoFar>> history_of(const SiteWork& site, const CampaignState& c) {
  const auto basis = site.histories.find(c.id);
  if (basis == site.histories.end()) return std::optional<HistorySoFar>();
  NONIO_TRY(auto history, assessment::history_so_far(site.options.out, basis->second));
  return std::optional(std::move(history));
}

bool wants_signature(const evaluation::Evaluated& evaluated) {
  const auto& outputs = evaluated.results.outputs;
  return std::any_of(outputs.begin(), outputs.end(), [](const Results::Written& w) {
    return std::any_of(w.result.artifacts.begin(), w.result.artifacts.end(),
                       [](const Artifact& a) { return a.sign; });
  });
}

Expected<evaluation::Evaluated> evaluated_apart(const SiteWork& site, const RegisterState& state,
                                                const CampaignState& c, const fs::path& folder,
                                                certificates::CampaignFiles& files, bool as_draft,
                                                bool& locked, Evaluator& evaluator) {
  NONIO_TRY(const auto history, history_of(site, c));
  NONIO_TRY(const auto analysed,
            evaluator.analyse(folder, c.id, site.twins ? *site.twins : twins_of(c, site.campaigns),
                              history));
  std::optional<evaluation::AssignedNumber> number;
  if (analysed.missing)
    number = number_of(site, state, analysed.evaluated, *analysed.missing, files, as_draft, locked);
  return evaluator.write_documents(c.id, std::move(number));
}

/// Sets `locked` if the campaign must wait for the register.
Expected<evaluation::Evaluated> certified(const SiteWork& site, const RegisterState& state,
                                          const CampaignState& c, process::SharedStatus& stage,
                                          bool& locked, Evaluator& evaluator) {
  const fs::path folder = site.options.site / c.folder;
  certificates::CampaignFiles files(folder);
  auto evaluation = evaluated_apart(site, state, c, folder, files, false, locked, evaluator);
  if (evaluation && site.numbers.held_up(*evaluation))
    evaluation = evaluated_apart(site, state, c, folder, files, true, locked, evaluator);
  if (!evaluation) return evaluation;
  evaluation::Evaluated& evaluated = *evaluation;
  if (locked && site.elsewhere) return evaluation;
  if (evaluated.status != evaluation::Status::failed) site.numbers.hold_unreleased(evaluated);
  if (site.elsewhere && evaluated.status != evaluation::Status::failed) {
    locked = wants_signature(evaluated);
    return evaluation;
  }
  stage.set("signing");
  auto done =
      certificates::sign_artifacts(evaluated, files, site.context, site.signer, std::time(nullptr));
  if (done) done = site.numbers.issue(evaluated, c.folder);
  locked = locked || (!done && storage::is_locked(done.error()));
  if (!done) fail_certificate(evaluated, done.error());
  return evaluation;
}

Answer work(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
            process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history) {
  if (first && site.signer != nullptr) site.signer->leave_to_worker();
  const CampaignState& c = site.campaigns[index];
  bool locked = false;
  const auto evaluation = certified(site, state, c, stage, locked, evaluator);
  if (!evaluation) {
    stage.set(evaluation.error().message);
    return Answer::not_stored;
  }
  const evaluation::Evaluated& evaluated = *evaluation;
  shows_history = evaluated.history.has_value();
  if (locked && !state.last_trial) return Answer::waits;
  if (evaluated.status == evaluation::Status::failed && !first) return Answer::again;
  const bool may_pass = evaluated.retry || is_of_the_machine(evaluated);
  if (evaluated.status == evaluation::Status::failed && !locked && !site.elsewhere &&
      !evaluated.results.errors.empty())
    site.numbers.note_failure(c.id, evaluated.results.errors.front().message);
  if (site.twins != nullptr && !(evaluated.certificate && evaluated.certificate->issued)) {
    stage.set(evaluated.results.errors.empty() ? "data are missing: run `nonio run` again"
                                               : evaluated.results.errors.front().message);
    return Answer::not_stored;
  }
  stage.set("writing the results");
  const auto staged = batch::stage(site.options.out, evaluated, site.context,
                                   {c.folder, site.run.of(), c.reason, may_pass});
  if (!staged) {
    stage.set(staged.error().message);
    return Answer::not_stored;
  }
  return evaluated.status == evaluation::Status::failed      ? Answer::failed
         : evaluated.status == evaluation::Status::attention ? Answer::attention
                                                             : Answer::ok;
}

/// Evaluates one campaign in the worker, while plugins run at the other end of the stream of
/// `evaluator`. If required, assigns a certificate number and signs. The files are staged. `first`
/// means the first campaign of this process. After Answer::not_stored, `stage` contains the reason.
/// Sets `shows_history` if a document contains the machine history.
Answer do_campaign(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
                   process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history) {
  try {
    return work(site, state, index, first, stage, evaluator, shows_history);
  } catch (const std::bad_alloc&) {
    stage.set(stage.get() +
              ": out of memory (the limit for one campaign is in site.toml, [limits])");
  } catch (const std::exception& e) {
    stage.set(stage.get() + ": " + e.what());
  }
  storage::remove_leftovers(storage::own_folder(site.options.out, site.campaigns[index].id));
  return Answer::not_stored;
}

using Action = CampaignState::Action;

/// Limits the memory that plugins do not release. If a plugin is not of the program's own folder,
/// and therefore not tested with it, each campaign gets its own process.
constexpr std::size_t campaigns_per_worker = 256;

std::string day_of(std::time_t time) {
  std::tm local{};
  ::localtime_r(&time, &local);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &local)};
}

class Runner {
 public:
  Runner(const RunOptions& options, const RunEvents& events, const reading::Context& context,
         const RunState& run, const ReleaseDesk& desk, std::vector<CampaignState>& campaigns)
      : options_(options),
        events_(events),
        context_(context),
        run_(run),
        signer_(desk.signer),
        plugins_(*desk.plugins),
        secrets_(config::secret_files(context.site, options.site)),
        numbers_({options.site, options.out, day_of(std::time(nullptr)), signer_ != nullptr},
                 context, desk.releasing),
        work_{options,
              context,
              run,
              campaigns,
              numbers_,
              signer_,
              desk.releasing ? &desk.releasing->twins : nullptr,
              desk.histories,
              desk.elsewhere},
        recheck_(desk.recheck),
        register_{.read = recheck_ == nullptr},
        histories_(desk.histories),
        campaigns_(campaigns),
        disk_(options.out),
        losses_(campaigns.size()),
        committer_([this](const std::vector<Committer::Given>& batch) {
          std::vector<Staged> staged;
          for (const Committer::Given& g : batch) staged.push_back(staged_of(g));
          return commit(options_.out, staged, run_.number, disk_);
        }),
        campaigns_per_worker_(context.plugins->all_from(options.own_plugins) ? campaigns_per_worker
                                                                             : 1) {}

  bool run() {
    process::keep_freed_memory();
    const std::size_t jobs =
        options_.jobs != 0 ? options_.jobs : std::max(1U, std::thread::hardware_concurrency());
    while (!process::is_stop_requested()) {
      while (workers_.size() < jobs && !process::is_stop_requested()) {
        const auto campaign = next();
        if (!campaign) break;
        start(*campaign);
      }
      if (!workers_.empty() || !committer_.pending().empty())
        wait();
      else if (waiting_.empty() || work_.elsewhere)
        return true;
      else
        wait_for_register();
    }
    stop();
    return false;
  }

 private:
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
    const auto task = [this](int stream) {
      return [this, stream](std::size_t c, bool first, process::SharedStatus& stage) {
        Evaluator evaluator(stream, secrets_);
        bool shows_history = false;
        const Answer answer =
            do_campaign(work_, register_, c, first, stage, evaluator, shows_history);
        return Outcome(answer, evaluator.grown(), shows_history);
      };
    };
    auto worker = Worker::start(plugins_, task, context_.site.limits.memory_MB);
    if (!worker) return not_started(campaign, worker.error().message);
    starts_failed_ = 0;
    workers_.push_back(std::move(*worker));
    give(workers_.back(), campaign);
  }

  /// Tries the campaign again, because a lack of resources may be temporary. After 20 failures in a
  /// row the campaign fails.
  void not_started(std::size_t campaign, const std::string& why) {
    constexpr int most = 20;
    if (++starts_failed_ >= most) {
      starts_failed_ = 0;
      return lost(campaign, why);
    }
    again_.push_back(campaign);
    if (!workers_.empty()) return wait();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    take_stored();
  }

  void give(Worker& worker, std::size_t campaign) {
    losses_[campaign] = disk_.losses();
    worker.give(campaign, std::chrono::duration_cast<Worker::Clock::duration>(
                              std::chrono::duration<double>(context_.site.limits.seconds)));
  }

  /// Ends the workers and stores the evaluated campaigns. Waits at most 10 s for the disk.
  void stop() {
    for (Worker& w : workers_) {
      w.end();
      storage::remove_leftovers(storage::own_folder(options_.out, campaigns_[w.campaign()].id));
    }
    workers_.clear();
    const auto deadline = Worker::Clock::now() + std::chrono::seconds(10);
    while (!committer_.pending().empty() && Worker::Clock::now() < deadline) {
      wait_for_answer(workers_, committer_.channel());
      take_stored();
    }
    committer_.end();
    for (const Committer::Given& g : committer_.pending())
      storage::remove_leftovers(storage::own_folder(options_.out, campaigns_[g.campaign].id));
  }

  /// Waits until the locked register can be read. After the time limit, the waiting campaigns are
  /// evaluated once more in any case.
  void wait_for_register() {
    using Clock = Worker::Clock;
    const config::Numbering& numbering = context_.site.numbering;
    if (!give_up_)
      give_up_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(numbering.patience));
    register_.last_trial = Clock::now() >= *give_up_;
    constexpr double now_and_then = 0.5;  // waiting time of one attempt, s
    auto numbers = read_apart<std::vector<certificates::RegisterEntry>>(
        "the register of certificates", context_.site.limits.disk_seconds,
        [&](process::SignsOfLife&) {
          return certificates::Register::entries(options_.site, numbering, now_and_then);
        });
    events_.tick();
    if (!numbers && storage::is_locked(numbers.error()) && !register_.last_trial) return;
    if (recheck_ && numbers) {
      if (const auto sound = recheck_(*numbers); !sound) register_.unsound = sound.error().message;
      recheck_ = nullptr;
      register_.read = true;
    }
    again_ = std::exchange(waiting_, {});
  }

  void wait() {
    if (signer_ != nullptr) signer_->revive();
    wait_for_answer(workers_, committer_.channel());
    plugins_.pass_on_prints();
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

  /// Returns whether the worker may evaluate another campaign: not after a failure, after its
  /// largest number of campaigns, if its memory has grown, or if a campaign waits for a new worker.
  bool take(Worker& worker, Answer answer) {
    switch (answer) {
      case Answer::ok:
      case Answer::attention:
      case Answer::failed:
        campaigns_[worker.campaign()].status = status_of(answer);
        note_history(campaigns_[worker.campaign()], worker.shows_history());
        store_staged(worker.campaign());
        return answer != Answer::failed && worker.given() < campaigns_per_worker_ &&
               !worker.grown() && again_.empty();
      case Answer::again:
        again_.push_back(worker.campaign());
        return false;
      case Answer::waits:
        waiting_.push_back(worker.campaign());
        return worker.given() < campaigns_per_worker_ && !worker.grown() && again_.empty();
      case Answer::not_stored:
        not_done(worker, worker.stage());
        return false;
      case Answer::none:
        break;
    }
    const std::string stage = worker.stage();
    const process::ChildEnd end = worker.end();
    not_done(worker, stage + ": " + (end.well ? "ended the process" : end.words));
    return false;
  }

  void note_history(CampaignState& c, bool shown) const {
    const auto basis = histories_.find(c.id);
    c.shows_history = shown;
    c.history = shown && basis != histories_.end() ? basis->second.sha256 : "";
  }

  /// Repeats the campaign in a new process, because an earlier campaign of the process may be the
  /// cause. The first campaign of a process fails.
  void not_done(Worker& worker, const std::string& why) {
    worker.end();
    if (worker.given() > 1)
      again_.push_back(worker.campaign());
    else
      lost(worker.campaign(), why);
  }

  Staged staged_of(const Committer::Given& g) const {
    return {campaigns_[g.campaign].id, g.losses};
  }

  std::string commit_here(const Committer::Given& given) const {
    const auto stored = commit(options_.out, {staged_of(given)}, run_.number, disk_).front();
    return stored ? "" : stored.error().message;
  }

  void store_staged(std::size_t campaign) {
    const Committer::Given given{campaign, losses_[campaign]};
    if (committer_.give(given)) return;
    // If no committer process can be started, this process stores the results.
    settle(campaign, commit_here(given));
  }

  void settle(std::size_t campaign, const std::string& error) {
    if (!error.empty())
      lost(campaign, error);
    else if (campaigns_[campaign].status == evaluation::Status::failed)
      take_failed(campaign);
    else
      finish(campaign, campaigns_[campaign].status, {});
  }

  void take_stored() {
    for (Committer::Done& done : committer_.done()) {
      if (done.again) done.error = commit_here(done.given);
      settle(done.given.campaign, done.error);
    }
  }

  void take_failed(std::size_t index) {
    const auto record =
        evaluation::read_record(storage::results_folder(options_.out, campaigns_[index].id));
    if (!record) return lost(index, "its record cannot be read: " + record.error().message);
    finish(index, record->status, record->errors);
  }

  static evaluation::Status status_of(Answer answer) {
    using evaluation::Status;
    return answer == Answer::ok          ? Status::ok
           : answer == Answer::attention ? Status::attention
                                         : Status::failed;
  }

  static std::string short_number(double x) {
    std::string s = std::to_string(x);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.ends_with('.')) s.pop_back();
    return s;
  }

  /// Stores the failure as the result of the campaign, except in an approval, which keeps the
  /// draft.
  void lost(std::size_t index, const std::string& why) {
    CampaignState& c = campaigns_[index];
    note_failure(c.id, why);
    if (work_.twins != nullptr) return finish(index, evaluation::Status::failed, {Error{why}});
    evaluation::Evaluated evaluated;
    evaluated.campaign.id = c.id;
    evaluated.status = evaluation::Status::failed;
    evaluated.results.errors = {Error{why}};
    const auto stored =
        store(options_.out, evaluated, context_, {c.folder, run_.of(), c.reason, true}, disk_);
    if (!stored)
      evaluated.results.errors.push_back(
          Error{"and this could not be stored: " + stored.error().message});
    finish(index, evaluation::Status::failed, std::move(evaluated.results.errors));
  }

  /// Does nothing after the register has not responded once.
  void note_failure(const std::string& campaign, const std::string& why) {
    if (register_hangs_ || work_.elsewhere) return;
    const auto noted =
        read_apart<bool>("the register of certificates", context_.site.limits.disk_seconds,
                         [&](process::SignsOfLife&) {
                           numbers_.note_failure(campaign, why);
                           return Expected<bool>(true);
                         });
    register_hangs_ = !noted;
  }

  void finish(std::size_t index, evaluation::Status status, std::vector<Error> errors) {
    CampaignState& c = campaigns_[index];
    c.action = Action::done;
    c.status = status;
    c.errors = std::move(errors);
    events_.finished(c);
  }

  const RunOptions& options_;
  const RunEvents& events_;
  const reading::Context& context_;
  const RunState& run_;
  certificates::Signer* signer_;
  PluginHost& plugins_;
  const std::vector<fs::path> secrets_;
  const certificates::Numbers numbers_;
  const SiteWork work_;
  NumbersCheck recheck_;  ///< empty after the check, or if no check is required
  RegisterState register_;
  const std::map<std::string, assessment::HistoryBasis>& histories_;
  std::vector<CampaignState>& campaigns_;
  const storage::Disk disk_;  ///< must be constructed before the first process that writes
  /// Number of lost writes that the disk had reported before each campaign.
  std::vector<std::uint32_t> losses_;
  Committer committer_;
  const std::size_t campaigns_per_worker_;
  std::size_t next_ = 0;
  int starts_failed_ = 0;  ///< failures in a row
  std::vector<std::size_t> again_;
  std::vector<std::size_t> waiting_;
  std::optional<Worker::Clock::time_point> give_up_;
  bool register_hangs_ = false;
  std::vector<Worker> workers_;
};

}  // namespace

bool do_campaigns(const RunOptions& options, const RunEvents& events,
                  const reading::Context& context, const RunState& run, const ReleaseDesk& desk,
                  std::vector<CampaignState>& campaigns) {
  return Runner(options, events, context, run, desk, campaigns).run();
}

}  // namespace nonio::batch
