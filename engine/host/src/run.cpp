// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/run.h"

#include <Poco/Environment.h>
#include <malloc.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>

#include "child.h"
#include "context.h"
#include "night_state.h"
#include "nonio/host/files.h"
#include "nonio/host/results_json.h"
#include "store.h"
#include "summary.h"
#include "survey.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
using Action = CampaignState::Action;

volatile std::sig_atomic_t stop_requested = 0;

/// Workers live for milliseconds: memory that is given back to the system is only faulted in again.
void keep_freed_memory() {
  constexpr int megabyte = 1 << 20;
  ::mallopt(M_MMAP_THRESHOLD, 32 * megabyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * megabyte);
  ::mallopt(M_TOP_PAD, megabyte);
}

/// What a worker was doing, readable by its parent after its death.
class SharedWords {
 public:
  SharedWords()
      : data_(static_cast<char*>(
            ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  SharedWords(SharedWords&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
  SharedWords& operator=(SharedWords&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
  }
  ~SharedWords() {
    if (data_ != nullptr) ::munmap(data_, size);
  }
  bool valid() const { return data_ != MAP_FAILED; }
  void set(const std::string& words_now) {
    const std::size_t n = std::min(words_now.size(), size - 1);
    std::memcpy(data_, words_now.data(), n);
    data_[n] = '\0';
  }
  std::string get() const { return {data_, ::strnlen(data_, size)}; }

 private:
  static constexpr std::size_t size = 4096;
  char* data_;
};

struct Worker {
  pid_t pid;
  int pidfd;
  std::size_t campaign;  // index
  Clock::time_point deadline;
  SharedWords stage;
};

/// glibc 2.36 declares pidfd_open without C linkage.
int open_pidfd(pid_t pid) { return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)); }

/// The last words of a worker that did everything; a plugin that calls exit(0) does not say them.
constexpr const char* stored_words = "stored";
constexpr int store_failed = 3;  // exit status of a worker that could not write

class Runner {
 public:
  Runner(const RunOptions& options, const RunEvents& events, const Context& context,
         const NightState& night, std::vector<CampaignState>& campaigns)
      : options_(options),
        events_(events),
        context_(context),
        night_(night),
        campaigns_(campaigns) {}

  /// False if it was interrupted.
  bool run() {
    keep_freed_memory();
    prepare_outputs();
    const std::size_t jobs =
        options_.jobs != 0 ? options_.jobs : Poco::Environment::processorCount();
    std::size_t next = 0;
    while (stop_requested == 0) {
      for (; workers_.size() < jobs && next < campaigns_.size() && stop_requested == 0; ++next)
        if (campaigns_[next].action == Action::todo) start(next);
      if (workers_.empty() && next >= campaigns_.size()) return true;
      wait();
    }
    for (Worker& w : workers_) {
      ::kill(-w.pid, SIGKILL);
      ::waitpid(w.pid, nullptr, 0);
      ::close(w.pidfd);
      remove_leftovers(options_.out / campaigns_[w.campaign].id);
    }
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

  void start(std::size_t index) {
    SharedWords stage;
    if (!stage.valid()) return lost(index, "no memory for a worker");
    stage.set("starting");
    std::cout.flush();
    std::cerr.flush();
    const pid_t pid = ::fork();
    if (pid < 0) return lost(index, std::string("no worker process: ") + std::strerror(errno));
    if (pid == 0) work(index, stage);
    ::setpgid(pid, pid);
    const auto limit = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(context_.site.limits.seconds));
    workers_.push_back({pid, open_pidfd(pid), index, Clock::now() + limit, std::move(stage)});
  }

  [[noreturn]] void work(std::size_t index, SharedWords& stage) const {
    settle_child();
    limit_memory(context_.site.limits.memory_MB);
    const CampaignState& c = campaigns_[index];
    const Evaluated evaluated = evaluate(options_.site / c.folder, c.id, context_,
                                         [&](const std::string& s) { stage.set(s); });
    stage.set("writing the results");
    const auto stored =
        store(options_.out, evaluated, context_, {c.folder, night_.number, c.reason, false});
    stage.set(stored ? stored_words : stored.error().message);
    ::_exit(stored ? 0 : store_failed);
  }

  void wait() {
    std::vector<pollfd> ends;
    for (const Worker& w : workers_) ends.push_back({w.pidfd, POLLIN, 0});
    ::poll(ends.data(), ends.size(), 100);
    for (std::size_t i = workers_.size(); i-- > 0;) {
      int status = 0;
      const pid_t gone = ::waitpid(workers_[i].pid, &status, WNOHANG);
      if (gone == workers_[i].pid)
        ended(i, child_end(status));
      else if (Clock::now() > workers_[i].deadline)
        overdue(i);
    }
    events_.tick();
  }

  void overdue(std::size_t i) {
    ::kill(-workers_[i].pid, SIGKILL);
    ::waitpid(workers_[i].pid, nullptr, 0);
    const auto seconds = short_number(context_.site.limits.seconds);
    ended(i,
          {false, "no end within the limit of " + seconds + " s ([limits] seconds in site.toml)"});
  }

  static std::string short_number(double x) {
    std::string s = std::to_string(x);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.ends_with('.')) s.pop_back();
    return s;
  }

  void ended(std::size_t i, const ChildEnd& end) {
    Worker worker = std::move(workers_[i]);
    workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(i));
    ::kill(-worker.pid, SIGKILL);  // what a plugin may have left running
    ::close(worker.pidfd);
    CampaignState& c = campaigns_[worker.campaign];
    const std::string stage = worker.stage.get();
    if (end.words == "exit status " + std::to_string(store_failed))
      return lost(worker.campaign, stage);
    if (!end.well) return lost(worker.campaign, stage + ": " + end.words);
    if (stage != stored_words) return lost(worker.campaign, stage + ": ended the process");
    const auto record = read_record(options_.out / c.id);
    if (!record)
      return lost(worker.campaign, "its record cannot be read: " + record.error().message);
    finish(c, *record);
  }

  /// The worker did not come back with results: the campaign is failed, and says why.
  void lost(std::size_t index, const std::string& why) {
    CampaignState& c = campaigns_[index];
    Evaluated evaluated;
    evaluated.campaign.id = c.id;
    evaluated.status = "failed";
    evaluated.results.errors = {Error{why}};
    const auto stored =
        store(options_.out, evaluated, context_, {c.folder, night_.number, c.reason, true});
    if (!stored) remove_leftovers(options_.out / c.id);
    c.action = Action::done;
    c.status = "failed";
    c.errors = evaluated.results.errors;
    events_.finished(c);
  }

  void finish(CampaignState& c, const Record& record) {
    c.action = Action::done;
    c.status = record.status;
    c.errors = record.errors;
    events_.finished(c);
  }

  const RunOptions& options_;
  const RunEvents& events_;
  const Context& context_;
  const NightState& night_;
  std::vector<CampaignState>& campaigns_;
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

}  // namespace

void request_stop() { stop_requested = 1; }

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
  std::vector<fs::path> template_folders = options.template_folders;
  if (fs::is_directory(options.site / "templates", error))
    template_folders.push_back(options.site / "templates");
  auto templates = read_templates(template_folders, context.templates_sha256);
  if (!templates) return refuse(all_of({templates.error()}));
  context.templates = std::move(*templates);

  Plugins plugins;
  plugins.load(options.plugin_folders);
  if (!plugins.conflicts().empty()) return refuse(plugins.conflicts().front());
  for (const PluginFile& f : plugins.files())
    if (!f.refused.empty())
      night.notes.push_back("plugin " + f.path.filename().string() + " " + f.refused);
  for (const std::string& note : night.notes) events.note(note);
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
  const auto state = begin_night(options.out, options.force, options.dry_run);
  if (!state) return refuse(state.error().message);
  const std::size_t notes_so_far = night.notes.size();
  auto campaigns =
      survey({options.site, options.out, context, state->number, state->force, night.notes});
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
  if (!Runner(options, events, context, *state, night.campaigns).run()) {
    night.end = Night::End::interrupted;
    return night;
  }
  auto [text, json] = summary(night, options.out, options.version);
  const auto written =
      publish(options.out, {{"summary.txt", std::move(text)}, {"summary.json", std::move(json)}});
  // The campaigns are safe; the night stays open, and the next run ends it.
  if (!written)
    night.error = written.error().message;
  else if (const auto ended = end_night(options.out, *state); !ended)
    night.error = ended.error().message;
  return night;
}

}  // namespace nonio::host
