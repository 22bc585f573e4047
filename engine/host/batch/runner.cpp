// SPDX-License-Identifier: Apache-2.0
#include "host/batch/runner.h"

#include <Poco/Environment.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <iterator>
#include <new>
#include <thread>

#include "host/batch/committer.h"
#include "host/batch/computing.h"
#include "host/batch/read_apart.h"
#include "host/batch/store.h"
#include "host/batch/twins.h"
#include "host/batch/worker.h"
#include "host/certificates/certificates.h"
#include "host/config/secret_files.h"
#include "host/process/child.h"
#include "host/storage/database.h"
#include "host/storage/disk.h"
#include "host/storage/files.h"

namespace nonio::host::batch {
namespace fs = std::filesystem;

namespace {

using Action = CampaignState::Action;

/// A worker is replaced after so many campaigns: starting one is then cheap, and what plugins may
/// leave behind in it does not grow old. Plugins from elsewhere than beside the program were not
/// tested with it: one of them, and every campaign gets a process of its own.
constexpr std::size_t campaigns_per_worker = 64;

constexpr const char* register_locked =
    "the register of certificates: another process keeps it locked since the begin of the night";

std::string day_of(std::time_t time) {
  std::tm local{};
  ::localtime_r(&time, &local);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &local)};
}

class Runner {
 public:
  Runner(const RunOptions& options, const RunEvents& events, const reading::Context& context,
         const NightState& night, const ReleaseDesk& desk, std::vector<CampaignState>& campaigns)
      : options_(options),
        events_(events),
        context_(context),
        night_(night),
        signer_(desk.signer),
        plugins_(*desk.plugins),
        secrets_(config::secret_files(context.site, options.site)),
        numbers_({options.site, options.out, day_of(std::time(nullptr)), signer_ != nullptr},
                 context, desk.releasing),
        releasing_(desk.releasing != nullptr),
        twins_(releasing_ ? &desk.releasing->twins : nullptr),
        recheck_(desk.recheck),
        histories_(desk.histories),
        campaigns_(campaigns),
        disk_(options.out),
        losses_(campaigns.size()),
        committer_([this](const std::vector<Committer::Given>& batch) {
          std::vector<Staged> staged;
          for (const Committer::Given& g : batch) staged.push_back(staged_of(g));
          return commit(options_.out, staged, night_.number, disk_);
        }),
        campaigns_per_worker_(context.plugins->all_from(options.own_plugins) ? campaigns_per_worker
                                                                             : 1) {}

  /// False if it was interrupted.
  bool run() {
    process::keep_freed_memory();
    const std::size_t jobs =
        options_.jobs != 0 ? options_.jobs : Poco::Environment::processorCount();
    while (!process::is_stop_requested()) {
      while (workers_.size() < jobs && !process::is_stop_requested()) {
        const auto campaign = next();
        if (!campaign) break;
        start(*campaign);
      }
      if (!workers_.empty() || !committer_.pending().empty())
        wait();
      else if (waiting_.empty())
        return true;
      else
        wait_for_register();
    }
    stop();
    return false;
  }

 private:
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
    const auto task = [this](int stream) {
      return [this, stream](std::size_t c, bool first, process::SharedStatus& stage) {
        Evaluator evaluator(stream, secrets_);
        bool shows_history = false;
        const Answer answer = work_guarded(c, first, stage, evaluator, shows_history);
        return Outcome(answer, evaluator.grown(), shows_history);
      };
    };
    auto worker = Worker::start(plugins_, task, context_.site.limits.memory_MB);
    if (!worker) return not_started(campaign, worker.error().message);
    starts_failed_ = 0;
    workers_.push_back(std::move(*worker));
    give(workers_.back(), campaign);
  }

  /// What the system refuses now it may give in a moment; the others go on meanwhile.
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

  /// What is evaluated is stored, what is not is given up. A disk that does not answer does not
  /// hold up the one who wants to stop.
  void stop() {
    for (Worker& w : workers_) {
      w.end();
      storage::remove_leftovers(storage::results_folder(options_.out, campaigns_[w.campaign()].id));
    }
    workers_.clear();
    const auto deadline = Worker::Clock::now() + std::chrono::seconds(10);
    while (!committer_.pending().empty() && Worker::Clock::now() < deadline) {
      wait_for_answer(workers_, committer_.channel());
      take_stored();
    }
    committer_.end();
    for (const Committer::Given& g : committer_.pending())
      storage::remove_leftovers(storage::results_folder(options_.out, campaigns_[g.campaign].id));
  }

  /// What needs the register that another process keeps to itself is done when all else is, or by
  /// the next night.
  void wait_for_register() {
    using Clock = Worker::Clock;
    const config::Numbering& numbering = context_.site.numbering;
    if (!give_up_)
      give_up_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(numbering.patience));
    last_trial_ = Clock::now() >= *give_up_;
    constexpr double now_and_then = 0.5;  // s
    auto numbers = read_apart<std::vector<certificates::RegisterEntry>>(
        "the register of certificates", context_.site.limits.disk_seconds,
        [&](process::SignsOfLife&) {
          return certificates::Register::entries(options_.site, numbering, now_and_then);
        });
    events_.tick();
    if (!numbers && storage::is_locked(numbers.error()) && !last_trial_) return;
    if (recheck_ && numbers) {
      if (const auto sound = recheck_(*numbers); !sound) unsound_ = sound.error().message;
      recheck_ = nullptr;
    }
    again_ = std::exchange(waiting_, {});
  }

  /// Read, analysed, numbered, written. `as_draft`: without a number, whatever the rules say.
  Expected<evaluation::Evaluated> evaluated_apart(const CampaignState& c, const fs::path& folder,
                                                  certificates::CampaignFiles& files, bool as_draft,
                                                  bool& locked, Evaluator& evaluator) const {
    const auto history = history_of(c);
    if (!history) return fail(history.error());
    const auto analysed =
        evaluator.analyse(folder, c.id, releasing_ ? *twins_ : twins_of(c, campaigns_), *history);
    if (!analysed) return fail(analysed.error());
    std::optional<evaluation::AssignedNumber> number;
    if (analysed->missing)
      number = number_of(analysed->evaluated, *analysed->missing, files, as_draft, locked);
    return evaluator.write_documents(c.id, std::move(number));
  }

  Expected<std::optional<HistorySoFar>> history_of(const CampaignState& c) const {
    const auto basis = histories_.find(c.id);
    if (basis == histories_.end()) return std::optional<HistorySoFar>();
    auto history = morning::history_so_far(options_.out, basis->second);
    if (!history) return fail(history.error());
    return std::optional(std::move(*history));
  }

  /// Refused while the register is not known to be sound, or another process keeps it to itself.
  evaluation::AssignedNumber number_of(const evaluation::Evaluated& evaluated,
                                       const std::vector<std::string>& missing,
                                       certificates::CampaignFiles& files, bool as_draft,
                                       bool& locked) const {
    evaluation::AssignedNumber assigned{std::nullopt, missing, std::nullopt};
    if (!unsound_.empty()) {
      assigned.error = Error{unsound_};
    } else if (recheck_ != nullptr) {
      locked = true;
      assigned.error = Error{register_locked};
    } else {
      assigned = numbers_.assign(evaluated, files, missing, as_draft);
      locked = locked || (assigned.error && storage::is_locked(*assigned.error));
    }
    return assigned;
  }

  /// Evaluated and, where it is to be, signed and entered. `locked`: not yet, since the register
  /// is.
  Expected<evaluation::Evaluated> certified(const CampaignState& c, process::SharedStatus& stage,
                                            bool& locked, Evaluator& evaluator) const {
    const fs::path folder = options_.site / c.folder;
    certificates::CampaignFiles files(folder);
    auto evaluation = evaluated_apart(c, folder, files, false, locked, evaluator);
    if (evaluation && numbers_.held_up(*evaluation))
      evaluation = evaluated_apart(c, folder, files, true, locked, evaluator);
    if (!evaluation) return evaluation;
    evaluation::Evaluated& evaluated = *evaluation;
    if (evaluated.status != evaluation::Status::failed) numbers_.hold_unreleased(evaluated);
    stage.set("signing");
    auto done =
        certificates::sign_artifacts(evaluated, files, context_, signer_, std::time(nullptr));
    if (done) done = numbers_.issue(evaluated, c.folder);
    locked = locked || (!done && storage::is_locked(done.error()));
    if (!done) fail_certificate(evaluated, done.error());
    return evaluation;
  }

  /// What plugins throw is caught where they are called.
  Answer work_guarded(std::size_t index, bool first, process::SharedStatus& stage,
                      Evaluator& evaluator, bool& shows_history) const {
    try {
      return work(index, first, stage, evaluator, shows_history);
    } catch (const std::bad_alloc&) {
      stage.set(stage.get() +
                ": out of memory (the limit for one campaign is in site.toml, [limits])");
    } catch (const std::exception& e) {
      stage.set(stage.get() + ": " + e.what());
    }
    storage::remove_leftovers(storage::results_folder(options_.out, campaigns_[index].id));
    return Answer::not_stored;
  }

  /// In the worker's process, which has no plugin code: that runs at the other end of the stream.
  Answer work(std::size_t index, bool first, process::SharedStatus& stage, Evaluator& evaluator,
              bool& shows_history) const {
    if (first && signer_ != nullptr) signer_->leave_to_worker();
    const CampaignState& c = campaigns_[index];
    bool locked = false;
    const auto evaluation = certified(c, stage, locked, evaluator);
    if (!evaluation) {
      stage.set(evaluation.error().message);
      return Answer::not_stored;
    }
    const evaluation::Evaluated& evaluated = *evaluation;
    shows_history = evaluated.history.has_value();
    if (locked && !last_trial_) return Answer::waits;
    if (evaluated.status == evaluation::Status::failed && !first) return Answer::again;
    const bool may_pass = evaluated.retry || is_of_the_machine(evaluated);
    if (evaluated.status == evaluation::Status::failed && !locked &&
        !evaluated.results.errors.empty())
      numbers_.note_failure(c.id, evaluated.results.errors.front().message);
    if (releasing_ && !(evaluated.certificate && evaluated.certificate->issued)) {
      stage.set(evaluated.results.errors.empty() ? "data are missing: run the night again"
                                                 : evaluated.results.errors.front().message);
      return Answer::not_stored;
    }
    stage.set("writing the results");
    const auto staged = batch::stage(options_.out, evaluated, context_,
                                     {c.folder, night_.of(), c.reason, may_pass});
    if (!staged) {
      stage.set(staged.error().message);
      return Answer::not_stored;
    }
    return evaluated.status == evaluation::Status::failed      ? Answer::failed
           : evaluated.status == evaluation::Status::attention ? Answer::attention
                                                               : Answer::ok;
  }

  /// Memory that was refused, and a disk or share that did not answer, say nothing about the
  /// readings.
  static bool is_of_the_machine(const Error& e) {
    if (e.message.find("out of memory") != e.message.npos) return true;
    constexpr int codes[] = {EIO, ESTALE, ETIMEDOUT, ENOTCONN, EHOSTDOWN, EHOSTUNREACH, ENOMEM};
    return std::any_of(std::begin(codes), std::end(codes),
                       [&](int code) { return e.message.ends_with(std::strerror(code)); });
  }
  static bool is_of_the_machine(const evaluation::Evaluated& evaluated) {
    const auto& errors = evaluated.results.errors;
    return std::any_of(errors.begin(), errors.end(),
                       [](const Error& e) { return is_of_the_machine(e); });
  }

  static void fail_certificate(evaluation::Evaluated& evaluated, const Error& why) {
    certificates::remove_unsigned(evaluated);
    evaluated.results.errors.push_back(why);
    evaluated.status = evaluation::Status::failed;
    evaluated.retry = true;
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

  /// Whether the worker may do another campaign. It may not after one that failed, and it makes
  /// room for a second trial, which is the first campaign of a new worker.
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
    c.history.reset();
    const auto basis = histories_.find(c.id);
    if (shown) c.history = basis == histories_.end() ? std::string() : basis->second.sha256;
  }

  /// Nobody pays for his predecessors: only what fails in a new process has failed.
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

  /// The error, empty if there is none.
  std::string commit_here(const Committer::Given& given) const {
    const auto stored = commit(options_.out, {staged_of(given)}, night_.number, disk_).front();
    return stored ? "" : stored.error().message;
  }

  void store_staged(std::size_t campaign) {
    const Committer::Given given{campaign, losses_[campaign]};
    if (committer_.give(given)) return;
    // Without a process of its own it takes a little longer.
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

  /// The worker did not come back with results: the campaign is failed, and says why.
  void lost(std::size_t index, const std::string& why) {
    CampaignState& c = campaigns_[index];
    note_failure(c.id, why);
    if (releasing_)
      return finish(index, evaluation::Status::failed, {Error{why}});  // the draft stays
    evaluation::Evaluated evaluated;
    evaluated.campaign.id = c.id;
    evaluated.status = evaluation::Status::failed;
    evaluated.results.errors = {Error{why}};
    const auto stored =
        store(options_.out, evaluated, context_, {c.folder, night_.of(), c.reason, true}, disk_);
    if (!stored)
      evaluated.results.errors.push_back(
          Error{"and this could not be stored: " + stored.error().message});
    finish(index, evaluation::Status::failed, std::move(evaluated.results.errors));
  }

  /// In the register. A share that hangs costs its limit once.
  void note_failure(const std::string& campaign, const std::string& why) {
    if (register_hangs_) return;
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
  const NightState& night_;
  certificates::Signer* signer_;  ///< null: nobody signs
  PluginHost& plugins_;
  const std::vector<fs::path> secrets_;
  const certificates::Numbers numbers_;
  const bool releasing_;         ///< what is not issued leaves everything as it was
  const reading::Twins* twins_;  ///< of the one campaign that is released
  NumbersCheck recheck_;
  const std::map<std::string, morning::HistoryBasis>& histories_;
  std::string unsound_;  ///< why no number is drawn
  std::vector<CampaignState>& campaigns_;
  const storage::Disk disk_;           ///< before the first process that writes
  std::vector<std::uint32_t> losses_;  ///< of the disk, when each campaign was begun
  Committer committer_;
  const std::size_t campaigns_per_worker_;
  std::size_t next_ = 0;
  int starts_failed_ = 0;             ///< one after the other
  std::vector<std::size_t> again_;    ///< get a second trial
  std::vector<std::size_t> waiting_;  ///< need the register, which is locked
  std::optional<Worker::Clock::time_point> give_up_;
  bool last_trial_ = false;
  bool register_hangs_ = false;
  std::vector<Worker> workers_;
};

}  // namespace

bool do_campaigns(const RunOptions& options, const RunEvents& events,
                  const reading::Context& context, const NightState& night, const ReleaseDesk& desk,
                  std::vector<CampaignState>& campaigns) {
  return Runner(options, events, context, night, desk, campaigns).run();
}

}  // namespace nonio::host::batch
