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

/// Answer of a worker at the end of a campaign.
enum class Answer : char {
  ok,
  attention,
  failed,
  again,       ///< failed and not written; an earlier campaign of the worker may be the cause
  waits,       ///< needs the register of certificates, which another process keeps locked
  not_stored,  ///< the results could not be stored; `Worker::stage` states why
  none,        ///< the process ended without an answer
};

class PluginHost;

struct Outcome {
  Outcome(Answer a, bool has_grown = false, bool history = false)
      : answer(a),
        grown(has_grown),
        shows_history(history) {}  // NOLINT: an Answer may be used as
                                   // an Outcome
  Answer answer;
  bool grown;          ///< whether the memory of the worker or of the evaluating process has grown
                       ///< by more than 64 MiB since its start
  bool shows_history;  ///< whether a document of the campaign shows the machine's history
};

/// A process that evaluates the campaigns requested by its parent, one after the other, together
/// with a second process that runs the plugins. At the end both are killed, with all processes that
/// they left running. Movable, not copyable.
class Worker {
 public:
  using Clock = std::chrono::steady_clock;
  /// Function that runs in the worker. `first` is true for the first campaign of this process.
  using Task =
      std::function<Outcome(std::size_t campaign, bool first, process::SharedStatus& stage)>;

  static Expected<Worker> start(const Task& task, double memory_MB);
  /// Starts a worker with a process that runs the plugins at the other end of the stream that
  /// `task` receives.
  static Expected<Worker> start(PluginHost& plugins, const std::function<Task(int stream)>& task,
                                double memory_MB);

  void give(std::size_t campaign, Clock::duration limit);
  std::size_t campaign() const { return campaign_; }
  std::size_t given() const { return given_; }
  bool overdue() const { return Clock::now() > deadline_; }
  std::string stage() const { return stage_.get(); }
  int channel() const { return channel_.get(); }

  /// Returns whether the memory of the worker or of the process with the plugins has grown by more
  /// than 64 MiB.
  bool grown() const { return grown_; }
  /// Whether a document of the last answered campaign shows the machine's history.
  bool shows_history() const { return shows_history_; }
  /// Returns the answer to the campaign that was given last: `Answer::none` if the process has
  /// ended without one, no value if there is no answer yet.
  std::optional<Answer> answer();
  /// Ends the worker. After Answer::none, returns how its process, or the one with the plugins, had
  /// ended.
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

/// Returns when a worker may have an answer, when the descriptor `other` (or -1) can be read, or
/// after 0.1 s.
void wait_for_answer(const std::vector<Worker>& workers, int other = -1);

}  // namespace nonio::batch
