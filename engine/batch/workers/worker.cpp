// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/worker.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "batch/workers/plugin_host.h"

namespace nonio::batch {

namespace {

struct Message {
  Answer answer;
  bool grown, shows_history;
};

void serve(const Worker::Task& task, int channel, process::SharedStatus& stage) {
  const std::size_t at_start = process::memory_held();
  bool first = true;
  for (std::size_t campaign; ::read(channel, &campaign, sizeof campaign) == sizeof campaign;) {
    const Outcome outcome = task(campaign, first, stage);
    const Message message{outcome.answer, outcome.grown || process::has_grown(at_start),
                          outcome.shows_history};
    if (::write(channel, &message, sizeof message) != sizeof message) break;
    first = false;
  }
}

}  // namespace

Expected<void> Worker::start_with(const Task& task, double memory_MB) {
  if (!stage_.valid()) return fail("no memory for a worker");
  NONIO_TRY(auto ends, process::channel_pair(SOCK_SEQPACKET, "a worker"));
  NONIO_TRY(child_,
            process::Child::start("a worker", {.memory_MB = memory_MB, .silent = true}, [&] {
              ends[0] = process::Handle();
              serve(task, ends[1].get(), stage_);
            }));
  channel_ = std::move(ends[0]);
  return {};
}

Expected<Worker> Worker::start(PluginHost& plugins, const std::function<Task(int)>& task,
                               double memory_MB) {
  Worker worker;
  NONIO_TRY(auto streams, process::channel_pair(SOCK_STREAM, "a process that evaluates"));
  NONIO_TRY(worker.plugins_, plugins.make_process(std::move(streams[1]), worker.stage_));
  if (auto started = worker.start_with(task(streams[0].get()), memory_MB); !started)
    return fail(started.error());
  return worker;
}

void Worker::give(std::size_t campaign, Clock::duration limit) {
  stage_.set("starting");
  campaign_ = campaign;
  ++given_;
  deadline_ = Clock::now() + limit;
  // If the worker has ended, answer() detects this.
  [[maybe_unused]] const ssize_t n = ::send(channel(), &campaign, sizeof campaign, MSG_NOSIGNAL);
}

std::optional<Answer> Worker::answer() {
  for (bool gone = false;;) {
    Message message{};
    const ssize_t n = ::recv(channel(), &message, sizeof message, MSG_DONTWAIT);
    const bool silent = n < 0 && (errno == EAGAIN || errno == EINTR);
    if (n == sizeof message && message.answer < Answer::none) {
      grown_ = message.grown;
      shows_history_ = message.shows_history;
      return message.answer;
    }
    if (gone || !silent) return Answer::none;
    // A process that a plugin has left may keep the channel open.
    gone = child_.has_ended();
    if (!gone) return std::nullopt;
  }
}

process::ChildEnd Worker::end() {
  const process::ChildEnd own = child_.end();
  const process::ChildEnd with_plugins = plugins_.end();
  return own.well ? with_plugins : own;
}

void wait_for_answer(const std::vector<Worker>& workers, int other) {
  std::vector<pollfd> channels{{other, POLLIN, 0}};
  for (const Worker& w : workers) channels.push_back({w.channel(), POLLIN, 0});
  ::poll(channels.data(), channels.size(), 100);
}

}  // namespace nonio::batch
