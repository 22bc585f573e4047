// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"
#include "platform/process/shared_status.h"

namespace nonio::batch {

/// Report of a worker at the end of a campaign.
enum class Answer : char {
  ok,
  attention,
  failed,
  again,       ///< failed, and not written: it may owe that to the worker's earlier campaigns
  waits,       ///< needs the register of certificates, which another process keeps locked
  not_stored,  ///< the worker's message states why
  none,        ///< the process ended without a word
};

class PluginHost;

struct Outcome {
  Outcome(Answer a, bool has_grown = false, bool history = false)
      : answer(a), grown(has_grown), shows_history(history) {}  // NOLINT: an answer is one
  Answer answer;
  bool grown;          ///< the memory of a process that works for this one
  bool shows_history;  ///< a document of the campaign requests the machine's
};

/// A process that does campaigns one after the other, as its parent names them; with another one
/// for what plugins do; at the end both are killed, and everything that they left running. Moved,
/// not copied.
class Worker {
 public:
  using Clock = std::chrono::steady_clock;
  /// Run in the process; `first`: no campaign was done in it before.
  using Task =
      std::function<Outcome(std::size_t campaign, bool first, process::SharedStatus& stage)>;

  static Expected<Worker> start(const Task& task, double memory_MB);
  /// With a process that has the plugins at the other end of the stream that the task is made with.
  static Expected<Worker> start(PluginHost& plugins, const std::function<Task(int stream)>& task,
                                double memory_MB);

  void give(std::size_t campaign, Clock::duration limit);
  std::size_t campaign() const { return campaign_; }
  std::size_t given() const { return given_; }
  bool overdue() const { return Clock::now() > deadline_; }
  std::string stage() const { return stage_.get(); }
  int channel() const { return channel_.get(); }

  /// Whether the memory of the process has grown noticeably since its start.
  bool grown() const { return grown_; }
  /// Of the campaign that was answered last.
  bool shows_history() const { return shows_history_; }
  /// The answer to the campaign that was given last, if there is one yet.
  std::optional<Answer> answer();
  /// After Answer::none: what became of the process, or of the one with the plugins.
  process::ChildEnd end();

 private:
  Worker() = default;
  Expected<void> start_with(const Task& task, double memory_MB);

  process::SharedStatus stage_;
  process::Handle channel_;
  process::Child child_, plugins_;
  std::size_t campaign_ = 0, given_ = 0;
  Clock::time_point deadline_{};
  bool grown_ = false, shows_history_ = false;
};

/// Returns when one of them may have an answer, when `other` (a descriptor, or -1) can be read, or
/// soon.
void wait_for_answer(const std::vector<Worker>& workers, int other = -1);

}  // namespace nonio::batch
