// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::process {

/// Signs of life of a child, readable by its parent while it hangs and after its death.
struct SignsOfLife {
  std::atomic<std::uint64_t> beats;
  std::atomic<std::uint64_t> index;  ///< of what it does
  std::atomic<bool> reads;           ///< it may wait for a disk; else it computes
  std::array<char, 8192> place;      ///< path that it reads

  void beat() { ++beats; }
  /// Before each step that may hang.
  void reading(std::string_view path);
  std::string reads_from() const { return {place.data(), ::strnlen(place.data(), place.size())}; }
};

/// A child process for what may hang (a disk, a share) or crash (a parser). What it sends arrives
/// in the same pieces; the parent waits for it no longer than it shows signs of life. Moved, not copied; killed at the
/// end.
class Watched {
 public:
  /// Sends a piece to the parent, not at once.
  using Send = std::function<void(std::string_view)>;
  using Task = std::function<void(SignsOfLife&, const Send&)>;

  /// `memory_MB`: none if 0.
  static Expected<Watched> start(const Task& task, double memory_MB = 0.0);
  int channel() const { return channel_.get(); }
  const SignsOfLife& signs() const { return *signs_; }
  /// What has come since the last call.
  std::vector<std::string> take();
  /// Nothing more can come: the process has ended.
  bool ended() const { return ended_; }
  /// No sign of life for so long.
  bool is_silent(double seconds);
  /// What became of the process. One that hangs is killed, and left behind if the kernel does not
  /// let it go at once.
  ChildEnd end() { return child_.end(); }

 private:
  using Clock = std::chrono::steady_clock;
  /// Memory that parent and child share.
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

/// Message about a place without response.
std::string no_answer(double seconds);

/// Returns when one of them may have sent something, or soon.
void wait_for_any(const std::vector<Watched>& children);

}  // namespace nonio::process
