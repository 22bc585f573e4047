// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/runner.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <thread>

#include "batch/commit/committer.h"
#include "batch/commit/store.h"
#include "batch/state/read_apart.h"
#include "batch/survey/twins.h"
#include "batch/workers/one_campaign.h"
#include "batch/workers/worker.h"
#include "campaign/config/secret_files.h"
#include "certificates/certificates.h"
#include "platform/process/child.h"
#include "platform/storage/database.h"
#include "platform/storage/disk.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

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
