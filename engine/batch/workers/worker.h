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

enum class Answer : char {
  ok,
  attention,
  failed,
  /// Failed and not stored, because an earlier campaign of the worker may be the cause.
  again,
  waits,
  not_stored,  ///< `Worker::stage` contains the reason
  none,        ///< the process ended without an answer
};

class PluginHost;

struct Outcome {
  Outcome(Answer a, bool has_grown = false, bool history = false)
      : answer(a), grown(has_grown), shows_history(history) {}  // NOLINT: an Answer may be used as
  Answer answer;
  bool grown;          ///< whether the memory of one of the processes has grown by more than 64 MiB
  bool shows_history;  ///< whether a document contains the machine history
};

/// A process that evaluates campaigns one by one, and a second process with the plugins. At the end
/// both are killed, with all processes that they have left. Movable, not copyable.
class Worker {
 public:
  using Clock = std::chrono::steady_clock;
  /// Runs in the worker; `first` means the first campaign of this process.
  using Task =
      std::function<Outcome(std::size_t campaign, bool first, process::SharedStatus& stage)>;

  /// `task` receives the stream to the process with the plugins.
  static Expected<Worker> start(PluginHost& plugins, const std::function<Task(int stream)>& task,
                                double memory_MB);

  void give(std::size_t campaign, Clock::duration limit);
  std::size_t campaign() const { return campaign_; }
  std::size_t given() const { return given_; }
  bool overdue() const { return Clock::now() > deadline_; }
  std::string stage() const { return stage_.get(); }
  int channel() const { return channel_.get(); }

  /// Whether the memory of one of the processes has grown by more than 64 MiB.
  bool grown() const { return grown_; }
  /// Whether a document of the last campaign contains the machine history.
  bool shows_history() const { return shows_history_; }
  /// Returns the answer to the last campaign: std::nullopt while it is evaluated, `Answer::none` if
  /// the process has ended without an answer.
  std::optional<Answer> answer();
  /// After Answer::none, the result describes how the process, or that with the plugins, has ended.
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

/// Returns when a worker may have an answer, when the descriptor `other` can be read (-1 for none),
/// or after 0.1 s.
void wait_for_answer(const std::vector<Worker>& workers, int other = -1);

}  // namespace nonio::batch
