// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "child.h"
#include "nonio/sdk/error.h"

namespace nonio::host {

/// What a worker is doing, readable by its parent after its death.
class SharedWords {
 public:
  SharedWords();
  SharedWords(SharedWords&& other) noexcept;
  SharedWords& operator=(SharedWords&& other) noexcept;
  ~SharedWords();
  bool valid() const { return data_ != nullptr; }
  void set(const std::string& words_now);
  std::string get() const;

 private:
  static constexpr std::size_t size = 4096;
  char* data_;
};

/// What a worker says when it is through with a campaign.
enum class Answer : char {
  ok,
  attention,
  failed,
  again,       ///< failed, and not written: it may owe that to the worker's earlier campaigns
  waits,       ///< needs the register of certificates, which another process keeps locked
  not_stored,  ///< why stands in the worker's words
  none,        ///< the process ended without a word
};

/// A process that does campaigns one after the other, as its parent names them. Moved, not copied.
class Worker {
 public:
  using Clock = std::chrono::steady_clock;
  /// Run in the process; `first`: no campaign was done in it before.
  using Task = std::function<Answer(std::size_t campaign, bool first, SharedWords& stage)>;

  static Expected<Worker> start(const Task& task, double memory_MB);
  Worker(Worker&& other) noexcept;
  Worker& operator=(Worker&& other) noexcept;
  ~Worker();  ///< kills the process and everything that it left running

  void give(std::size_t campaign, Clock::duration limit);
  std::size_t campaign() const { return campaign_; }
  std::size_t given() const { return given_; }
  bool overdue() const { return Clock::now() > deadline_; }
  std::string stage() const { return stage_.get(); }
  int channel() const { return channel_; }

  /// Whether the memory of the process has grown noticeably since its start.
  bool grown() const { return grown_; }
  /// The answer to the campaign that was given last, if there is one yet.
  std::optional<Answer> answer();
  /// After Answer::none: what became of the process.
  ChildEnd end();

 private:
  Worker(pid_t pid, int channel, SharedWords stage);

  pid_t pid_;
  int channel_;
  SharedWords stage_;
  std::size_t campaign_ = 0, given_ = 0;
  Clock::time_point deadline_{};
  bool grown_ = false;
};

/// Returns when one of them may have an answer, when `other` (a descriptor, or -1) can be read, or
/// soon.
void wait_for_answer(const std::vector<Worker>& workers, int other = -1);

}  // namespace nonio::host
