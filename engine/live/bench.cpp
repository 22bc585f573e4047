// SPDX-License-Identifier: Apache-2.0
#include "live/bench.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "platform/process/child.h"
#include "platform/process/confine.h"
#include "platform/storage/serialise.h"

namespace nonio::live {
using storage::Json;

namespace {

class SharedColumn {
 public:
  explicit SharedColumn(std::size_t size) : size_(size) {
    void* const at =
        ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<double*>(at);
  }
  SharedColumn(const SharedColumn&) = delete;
  SharedColumn& operator=(const SharedColumn&) = delete;
  ~SharedColumn() { ::munmap(data_, bytes()); }
  std::span<double> values() { return {data_, size_}; }

 private:
  std::size_t bytes() const { return std::max<std::size_t>(size_, 1) * sizeof(double); }
  std::size_t size_;
  double* data_ = nullptr;
};

class FittedBefore {
 public:
  std::shared_ptr<SharedColumn> find(const std::string& key) const {
    for (const auto& [known, residual] : all_)
      if (known == key) return residual;
    return nullptr;
  }
  void put(const std::string& key, std::shared_ptr<SharedColumn> residual) {
    std::erase_if(all_, [&](const auto& one) { return one.first == key; });
    all_.emplace_back(key, std::move(residual));
    if (all_.size() > most) all_.pop_front();
  }

 private:
  // Calculations with residuals need no new fit after undo and redo. An entry takes 8 MB for
  // 1,000,000 readings.
  static constexpr std::size_t most = 8;
  std::deque<std::pair<std::string, std::shared_ptr<SharedColumn>>> all_;
};

using Clock = std::chrono::steady_clock;

struct Job {
  std::uint64_t number = 0;
  Json request;
  std::string key, kind, part;
};

struct Running {
  Job job;
  process::Child child;
  process::Handle pipe{};
  std::string received{};
  std::shared_ptr<SharedColumn> residual{};
  bool fills = false;
  bool is_begun = false;  ///< whether the first part of the answer was sent
  Clock::time_point begun = Clock::now();
  int reported = 0;
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

std::string words_of(const Error& e) {
  return (e.file.empty() ? "" : e.file + (e.line != 0 ? ":" + std::to_string(e.line) : "") + ": ") +
         e.message;
}

/// First byte of the output of a child: `answers` precedes an answer, `refuses` the reason of a
/// rejection. Before them, `begins`, a length and a text may contain the first part of the answer.
constexpr char begins = '1', answers = '+', refuses = '-';
constexpr std::size_t before_first = 1 + sizeof(std::uint64_t);

void send_first(int pipe, const std::string& text) {
  const std::uint64_t size = text.size();
  std::string bytes(before_first, begins);
  std::memcpy(bytes.data() + 1, &size, sizeof size);
  write_all(pipe, bytes + text);
}

/// Returns std::nullopt until the first part of the answer is complete, then removes it from
/// `received`.
std::optional<std::string> take_first(std::string& received) {
  std::uint64_t size = 0;
  if (received.size() < before_first || received.front() != begins) return std::nullopt;
  std::memcpy(&size, received.data() + 1, sizeof size);
  if (received.size() - before_first < size) return std::nullopt;
  std::string out = received.substr(before_first, size);
  received.erase(0, before_first + size);
  return out;
}

std::string answer_of(Bench& bench, const Job& job, std::span<double> residual, bool fitted,
                      int pipe) {
  try {
    auto done = calculate(bench, job.request, residual, fitted,
                          [pipe](const std::string& text) { send_first(pipe, text); });
    if (done) return answers + *done;
    return refuses + words_of(done.error());
  } catch (const std::bad_alloc&) {
    return refuses + std::string("out of memory (the limit is in site.toml, [limits])");
  } catch (const std::exception& e) {
    return refuses + std::string(e.what());
  }
}

bool is_slow(const Job& job) { return job.kind == "explain" || job.kind == "without"; }

/// Returns the nice value: 10 for slow jobs, 5 for jobs without a waiting user and for fits of more
/// than 100,000 readings, otherwise 0.
int niceness(const Job& job, const Bench& bench) {
  constexpr std::size_t takes_seconds = 100000;  // a fit of more readings takes seconds
  if (is_slow(job)) return 10;
  if (job.number == 0) return 5;
  for (const auto& part : bench.parts)
    if (job.kind == "fit" && part.part.name == job.part && part.part.table.size() > takes_seconds)
      return 5;
  return 0;
}

void do_job(Bench& bench, const Job& job, int pipe, std::span<double> residual, bool fitted) {
  if (const int nice = niceness(job, bench); nice > 0) ::setpriority(PRIO_PROCESS, 0, nice);
  if (!needs_files(job.kind)) {
    std::string why = process::confine_files();
    if (why.empty()) why = process::confine_computing();
    if (!why.empty()) {
      write_all(pipe, refuses + ("the plugins cannot be confined: " + why));
      ::_exit(1);
    }
  }
  const std::string answer = answer_of(bench, job, residual, fitted, pipe);
  ::_exit(write_all(pipe, answer) ? 0 : 1);
}

class Loop {
 public:
  Loop(Bench bench, process::Handle channel)
      : bench_(std::move(bench)),
        channel_(std::move(channel)),
        seconds_(bench_.place->context.site.limits.seconds) {}

  void run() {
    tell(0, job_state::opened, storage::dump(described(bench_)));
    if (!bench_.has_catalogue) {
      Job& job = waiting_.emplace_back();
      job.request["kind"] = job.kind = "catalogue";
    }
    while (!gone_) {
      start_what_may();
      wait();
      look_after();
    }
    running_.clear();
  }

 private:
  static constexpr std::size_t most_running = 8, most_slow = 2, most_waiting = 64;

  void tell(std::uint64_t number, const char* state, std::string_view text) {
    if (!process::write_text(channel_.get(), storage::pack(number, std::string_view(state), text)))
      gone_ = true;
  }

  /// Whether a user waits for this fit. Slow jobs are started when the fit is ready or has taken
  /// longer than a second.
  bool is_awaited(const Running& one) const {
    constexpr auto long_time = std::chrono::seconds(1);
    return one.job.kind == "fit" && !one.is_begun && niceness(one.job, bench_) == 0 &&
           Clock::now() - one.begun < long_time;
  }

  void start_what_may() {
    std::size_t slow = 0;
    for (const auto& [number, one] : running_)
      slow += is_awaited(one) ? most_slow : is_slow(one.job) ? 1 : 0;
    for (const bool is_quick : {true, false})
      for (auto it = waiting_.begin(); it != waiting_.end();) {
        const bool may = is_slow(*it) != is_quick && running_.size() < most_running &&
                         (is_quick || slow < most_slow);
        if (!may) {
          ++it;
          continue;
        }
        start(*it);
        const auto started = running_.find(it->number);
        if (started != running_.end() && is_awaited(started->second))
          slow += most_slow;
        else
          slow += is_quick ? 0 : 1;
        it = waiting_.erase(it);
      }
  }

  void start(const Job& job) {
    const bool fills = job.kind == "fit" || needs_residual(job.request);
    const auto known = job.kind == "fit" ? nullptr : fitted_[job.part].find(job.key);
    const bool fitted = known != nullptr;
    const modelling::PartModel* const part = bench_.part(job.part);
    std::shared_ptr<SharedColumn> residual;
    try {
      residual = fitted ? known
                        : std::make_shared<SharedColumn>(
                              fills && part != nullptr ? part->part.table.size() : 0);
    } catch (const std::bad_alloc&) {
      return tell(job.number, job_state::failed, "out of memory");
    }
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
      return tell(job.number, job_state::failed, std::strerror(errno));
    process::Handle from(ends[0]), to(ends[1]);
    const double memory_MB = bench_.place->context.site.limits.memory_MB;
    auto child = process::Child::start("a request", {.memory_MB = memory_MB}, [&] {
      from = process::Handle();
      channel_ = process::Handle();
      do_job(bench_, job, to.get(), residual->values(), fitted);
    });
    if (!child) return tell(job.number, job_state::failed, child.error().message);
    if (job.number != 0) tell(job.number, job_state::running, "0");
    Running& one = running_[job.number];
    one.job = job, one.child = *std::move(child), one.pipe = std::move(from);
    one.residual = std::move(residual), one.fills = fills;
  }

  /// Whether this process must prepare matrices that all later requests need. It does so only while
  /// no other jobs than slow ones are running.
  bool has_work() const {
    return without_groundwork(bench_) != nullptr &&
           std::all_of(running_.begin(), running_.end(),
                       [](const auto& one) { return is_slow(one.second.job); });
  }

  void wait() {
    std::vector<pollfd> all{{channel_.get(), POLLIN, 0}};
    for (const auto& [number, one] : running_) all.push_back({one.pipe.get(), POLLIN, 0});
    constexpr int tick = 200, idle = 150;
    const int patience = has_work() ? idle : running_.empty() ? -1 : tick;
    if (::poll(all.data(), all.size(), patience) <= 0) {
      if (patience == idle) do_groundwork(bench_, *without_groundwork(bench_));
      return;
    }
    if (all.front().revents != 0) take_request();
    std::size_t k = 1;
    std::vector<std::uint64_t> ended;
    for (auto& [number, one] : running_) {
      if (k < all.size() && all[k].fd == one.pipe.get() && all[k].revents != 0) {
        if (!read_from(one)) ended.push_back(number);
        if (const auto first = take_first(one.received)) {
          one.is_begun = true;
          keep_residual(one);
          tell(number, job_state::begun, *first);
        }
      }
      ++k;
    }
    for (const std::uint64_t number : ended) finish(number);
  }

  /// Returns false at the end of the stream.
  static bool read_from(Running& one) {
    std::array<char, 1 << 16> bytes;
    const ssize_t n = ::read(one.pipe.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) return true;
    if (n <= 0) return false;
    one.received.append(bytes.data(), static_cast<std::size_t>(n));
    return true;
  }

  void take_request() {
    std::string bytes;
    if (!process::read_text(channel_.get(), bytes)) {
      gone_ = true;
      return;
    }
    std::string what, text;
    std::uint64_t number = 0;
    if (!storage::unpack(bytes, what, number, text)) return;
    if (what == "cancel") return cancel(number);
    Job job{number, storage::parse(text), "", "", ""};
    job.kind = job.request.value("kind", "");
    job.part = job.request.value("part", "");
    job.key = trial_key(job.request);
    if (waiting_.size() == most_waiting)
      return tell(number, job_state::failed, "too many requests wait");
    waiting_.push_back(std::move(job));
  }

  void cancel(std::uint64_t number) {
    std::erase_if(waiting_, [&](const Job& job) { return job.number == number; });
    const auto found = running_.find(number);
    if (found == running_.end()) return;
    // The job may be writing files and must not be ended.
    if (needs_files(found->second.job.kind)) return;
    running_.erase(found);
  }

  void finish(std::uint64_t number) {
    const auto found = running_.find(number);
    Running one = std::move(found->second);
    running_.erase(found);
    const process::ChildEnd end = one.child.wait(5.0);
    if (one.received.empty() || one.received.front() == begins ||
        (!end.well && one.received.front() == answers))
      return tell(number, job_state::failed,
                  "a plugin brought the process down in which it ran: " +
                      (end.well ? std::string("it ended without an answer") : end.words));
    const std::string_view text = std::string_view(one.received).substr(1);
    if (one.received.front() == refuses) return tell(number, job_state::failed, text);
    keep_residual(one);
    if (one.job.kind == "save") take_saved(text);
    tell(number, number == 0 ? job_state::catalogue : job_state::done, text);
  }

  void keep_residual(const Running& one) {
    if (one.fills) fitted_[one.job.part].put(one.job.key, one.residual);
  }

  void take_saved(std::string_view text) {
    const Json saved = storage::parse(text);
    bench_.read.manifest->campaign.model = saved.at("model").get<std::vector<std::string>>();
    bench_.read.inputs.front().second = saved.at("manifest_sha256").get<std::string>();
  }

  void look_after() {
    std::vector<std::uint64_t> overdue;
    for (auto& [number, one] : running_) {
      const double seconds = std::chrono::duration<double>(Clock::now() - one.begun).count();
      if (seconds > seconds_) {
        overdue.push_back(number);
      } else if (seconds >= one.reported + 1) {
        one.reported = static_cast<int>(seconds);
        if (number != 0) tell(number, job_state::running, std::to_string(one.reported));
      }
    }
    for (const std::uint64_t number : overdue) {
      running_.erase(number);
      tell(number, job_state::failed,
           "no answer within " + std::to_string(static_cast<int>(seconds_)) +
               " s (site.toml, [limits] seconds)");
    }
  }

  Bench bench_;
  process::Handle channel_;
  double seconds_;
  std::deque<Job> waiting_;
  std::map<std::uint64_t, Running> running_;
  std::map<std::string, FittedBefore> fitted_;
  bool gone_ = false;
};

}  // namespace

void run_bench(const BenchWish& wish, process::Handle channel) {
  try {
    auto bench = open_bench(wish);
    if (!bench) {
      process::write_text(channel.get(),
                          storage::pack(std::uint64_t{0}, std::string_view(job_state::failed),
                                        words_of(bench.error())));
      ::_exit(1);
    }
    Loop(std::move(*bench), std::move(channel)).run();
  } catch (const std::exception& e) {
    std::cerr << "nonio live: " << e.what() << "\n";
    ::_exit(1);
  }
  ::_exit(0);
}

}  // namespace nonio::live
