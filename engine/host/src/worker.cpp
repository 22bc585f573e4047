// SPDX-License-Identifier: Apache-2.0
#include "worker.h"

#include <malloc.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>
#include <utility>

namespace nonio::host {

namespace {

struct Message {
  Answer answer;
  bool grown;
};

/// More than the tables and reports of a campaign need, far less than would hurt the next one.
constexpr std::size_t growth_allowed = 64 << 20;

/// Bytes that the process has from the system for its data.
std::size_t memory_held() {
  const auto info = ::mallinfo2();
  return info.arena + info.hblkhd;
}

[[noreturn]] void serve(const Worker::Task& task, int channel, double memory_MB,
                        SharedWords& stage) noexcept {
  settle_child();
  limit_memory(memory_MB);
  const std::size_t at_start = memory_held();
  bool first = true;
  for (std::size_t campaign; ::read(channel, &campaign, sizeof campaign) == sizeof campaign;) {
    Message message{task(campaign, first, stage), false};
    message.grown = memory_held() > at_start + growth_allowed;
    if (::write(channel, &message, sizeof message) != sizeof message) break;
    first = false;
  }
  ::_exit(0);
}

}  // namespace

SharedWords::SharedWords() {
  void* data = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  data_ = data == MAP_FAILED ? nullptr : static_cast<char*>(data);
}
SharedWords::SharedWords(SharedWords&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)) {}
SharedWords& SharedWords::operator=(SharedWords&& other) noexcept {
  std::swap(data_, other.data_);
  return *this;
}
SharedWords::~SharedWords() {
  if (data_ != nullptr) ::munmap(data_, size);
}
void SharedWords::set(const std::string& words_now) {
  const std::size_t n = std::min(words_now.size(), size - 1);
  std::memcpy(data_, words_now.data(), n);
  data_[n] = '\0';
}
std::string SharedWords::get() const { return {data_, ::strnlen(data_, size)}; }

Expected<Worker> Worker::start(const Task& task, double memory_MB) {
  SharedWords stage;
  if (!stage.valid()) return fail("no memory for a worker");
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(std::string("no channel to a worker: ") + std::strerror(errno));
  std::cout.flush();
  std::cerr.flush();
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::close(ends[0]);
    serve(task, ends[1], memory_MB, stage);
  }
  const int code = errno;
  ::close(ends[1]);
  if (pid < 0) {
    ::close(ends[0]);
    return fail(std::string("no worker process: ") + std::strerror(code));
  }
  ::setpgid(pid, pid);
  return Worker(pid, ends[0], std::move(stage));
}

Worker::Worker(pid_t pid, int channel, SharedWords stage)
    : pid_(pid), channel_(channel), stage_(std::move(stage)) {}

Worker::Worker(Worker&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      channel_(std::exchange(other.channel_, -1)),
      stage_(std::move(other.stage_)),
      campaign_(other.campaign_),
      given_(other.given_),
      deadline_(other.deadline_),
      grown_(other.grown_) {}

Worker& Worker::operator=(Worker&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(channel_, other.channel_);
  std::swap(stage_, other.stage_);
  campaign_ = other.campaign_;
  given_ = other.given_;
  deadline_ = other.deadline_;
  grown_ = other.grown_;
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

ChildEnd Worker::end() {
  if (pid_ < 0) return {};
  // A process that closed its channel by ending keeps the status it ended with.
  int status = 0;
  ::kill(-pid_, SIGKILL);
  ::waitpid(std::exchange(pid_, -1), &status, 0);
  return child_end(status);
}

void wait_for_answer(const std::vector<Worker>& workers, int other) {
  std::vector<pollfd> channels{{other, POLLIN, 0}};
  for (const Worker& w : workers) channels.push_back({w.channel(), POLLIN, 0});
  ::poll(channels.data(), channels.size(), 100);
}

}  // namespace nonio::host
