// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::process {

/// Signs of life of a child in shared memory. The parent can read them while the child hangs and
/// after it has ended.
struct SignsOfLife {
  std::atomic<std::uint64_t> beats;
  std::atomic<std::uint64_t> index;  ///< index of the present task
  std::atomic<bool> reads;           ///< true while the child may wait for a disk
  std::array<char, 8192> place;      ///< path of the file that is being read

  void beat() { ++beats; }
  /// Stores the path before a step that may wait for a disk.
  void reading(std::string_view path);
  std::string reads_from() const { return {place.data(), ::strnlen(place.data(), place.size())}; }
};

/// A child process for work that may hang (a disk, a share) or crash (a parser). The child is
/// killed at the end of the lifetime.
class Watched {
 public:
  /// Queues a message for the parent. It is sent when 32 KiB are queued and when the task returns.
  using Send = std::function<void(std::string_view)>;
  using Task = std::function<void(SignsOfLife&, const Send&)>;

  /// `memory_MB` limits the private memory of the child (1 MB = 10^6 bytes), unless it is 0.
  static Expected<Watched> start(const Task& task, double memory_MB = 0.0);
  int channel() const { return channel_.get(); }
  const SignsOfLife& signs() const { return *signs_; }
  /// Returns the complete messages that have arrived since the last call.
  std::vector<std::string> take();
  /// Whether the child has closed its channel, so that no further message can arrive.
  bool ended() const { return ended_; }
  /// Whether there was no sign of life for more than `seconds`.
  bool is_silent(double seconds);
  ChildEnd end() { return child_.end(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Shared {
    void operator()(SignsOfLife* signs) const;
  };

  std::unique_ptr<SignsOfLife, Shared> signs_{};
  Handle channel_{};
  Child child_{};
  std::string received_{};
  bool ended_ = false;
  std::uint64_t beats_ = 0;
  Clock::time_point last_beat_ = Clock::now();
};

/// Returns the error message for a disk or share that did not respond within `seconds`.
std::string no_answer(double seconds);

/// Returns when a message can be read, at the latest after 0.1 s.
void wait_for_any(const std::vector<Watched>& children);

}  // namespace nonio::process
