// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/worker.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iostream>
#include <utility>

#include "batch/workers/plugin_host.h"
#include "platform/process/channel.h"

namespace nonio::batch {

namespace {

struct Message {
  Answer answer;
  bool grown, shows_history;
};

[[noreturn]] void serve(const Worker::Task& task, int channel, double memory_MB,
                        process::SharedStatus& stage) noexcept {
  process::init_child();
  process::keep_silent();
  process::limit_memory(memory_MB);
  const std::size_t at_start = process::memory_held();
  bool first = true;
  for (std::size_t campaign; ::read(channel, &campaign, sizeof campaign) == sizeof campaign;) {
    const Outcome outcome = task(campaign, first, stage);
    const Message message{outcome.answer, outcome.grown || process::has_grown(at_start),
                          outcome.shows_history};
    if (::write(channel, &message, sizeof message) != sizeof message) break;
    first = false;
  }
  ::_exit(0);
}

}  // namespace

Expected<Worker> Worker::prepare(int& theirs) {
  process::SharedStatus stage;
  if (!stage.valid()) return fail("no memory for a worker");
  NONIO_TRY(auto ends, process::channel_pair(SOCK_SEQPACKET, "a worker"));
  theirs = ends[1].release();
  return Worker(ends[0].release(), std::move(stage));
}

Expected<void> Worker::fork_with(const Task& task, double memory_MB, int theirs) {
  std::cout.flush();
  std::cerr.flush();
  pid_ = ::fork();
  if (pid_ == 0) {
    ::close(channel_);
    serve(task, theirs, memory_MB, stage_);
  }
  const int code = errno;
  ::close(theirs);
  if (pid_ < 0) return fail(std::string("no worker process: ") + std::strerror(code));
  ::setpgid(pid_, pid_);
  return {};
}

Expected<Worker> Worker::start(const Task& task, double memory_MB) {
  int theirs = -1;
  auto worker = prepare(theirs);
  if (!worker) return worker;
  if (auto forked = worker->fork_with(task, memory_MB, theirs); !forked)
    return fail(forked.error());
  return worker;
}

Expected<Worker> Worker::start(PluginHost& plugins, const std::function<Task(int)>& task,
                               double memory_MB) {
  int theirs = -1;
  NONIO_TRY(auto streams, process::channel_pair(SOCK_STREAM, "a process that evaluates"));
  auto worker = prepare(theirs);
  if (!worker) return worker;
  const auto pid = plugins.make_process(std::move(streams[1]), worker->stage_);
  if (pid) {
    worker->plugins_ = *pid;
    ::setpgid(*pid, *pid);
  } else {
    ::close(theirs);
    return fail(pid.error());
  }
  if (auto forked = worker->fork_with(task(streams[0].get()), memory_MB, theirs); !forked)
    return fail(forked.error());
  return worker;
}

Worker::Worker(int channel, process::SharedStatus stage)
    : channel_(channel), stage_(std::move(stage)) {}

Worker::Worker(Worker&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      plugins_(std::exchange(other.plugins_, -1)),
      channel_(std::exchange(other.channel_, -1)),
      stage_(std::move(other.stage_)),
      campaign_(other.campaign_),
      given_(other.given_),
      deadline_(other.deadline_),
      grown_(other.grown_),
      shows_history_(other.shows_history_) {}

Worker& Worker::operator=(Worker&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(plugins_, other.plugins_);
  std::swap(channel_, other.channel_);
  stage_ = std::move(other.stage_);
  campaign_ = other.campaign_;
  given_ = other.given_;
  deadline_ = other.deadline_;
  grown_ = other.grown_;
  shows_history_ = other.shows_history_;
  return *this;
}

Worker::~Worker() {
  end();
  if (channel_ >= 0) ::close(channel_);
}

void Worker::give(std::size_t campaign, Clock::duration limit) {
  stage_.set("starting");
  campaign_ = campaign;
  ++given_;
  deadline_ = Clock::now() + limit;
  // A worker that is dead already is found by answer().
  [[maybe_unused]] const ssize_t n = ::send(channel_, &campaign, sizeof campaign, MSG_NOSIGNAL);
}

std::optional<Answer> Worker::answer() {
  for (bool gone = false;;) {
    Message message{};
    const ssize_t n = ::recv(channel_, &message, sizeof message, MSG_DONTWAIT);
    const bool silent = n < 0 && (errno == EAGAIN || errno == EINTR);
    if (n == sizeof message && message.answer < Answer::none) {
      grown_ = message.grown;
      shows_history_ = message.shows_history;
      return message.answer;
    }
    if (gone || !silent) return Answer::none;
    // What a plugin left running may hold the channel open.
    siginfo_t info{};
    gone = ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == pid_;
    if (!gone) return std::nullopt;
  }
}

namespace {

/// A process that closed its channel by ending keeps the status it ended with.
process::ChildEnd end_group(pid_t& pid) {
  if (pid < 0) return {true, {}};
  return process::end_child(std::exchange(pid, -1));
}

}  // namespace

process::ChildEnd Worker::end() {
  const process::ChildEnd own = end_group(pid_);
  const process::ChildEnd with_plugins = end_group(plugins_);
  return own.well ? with_plugins : own;
}

void wait_for_answer(const std::vector<Worker>& workers, int other) {
  std::vector<pollfd> channels{{other, POLLIN, 0}};
  for (const Worker& w : workers) channels.push_back({w.channel(), POLLIN, 0});
  ::poll(channels.data(), channels.size(), 100);
}

}  // namespace nonio::batch
