// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"

namespace nonio::live {

/// Takes connections on 127.0.0.1 and hands each on when the whole head of its request is there:
/// one who sends a byte now and then keeps no thread. One thread.
class Front {
 public:
  static constexpr std::size_t most_waiting = 128;
  static constexpr std::chrono::seconds head_patience{5};

  /// `port` 0: the kernel chooses one.
  static Expected<Front> open(std::uint16_t port);
  std::uint16_t port() const { return port_; }

  /// `take` gets a socket whose next bytes are a head, still unread; or the status with which it is
  /// to be refused (408: too slow, 431: too large). Until `is_over`, asked several times a second.
  void serve(const std::function<void(process::Handle, int refused)>& take,
             const std::function<bool()>& is_over);

 private:
  using Clock = std::chrono::steady_clock;
  Front(process::Handle socket, std::uint16_t port) : socket_(std::move(socket)), port_(port) {}
  void accept_all();
  /// Whether the head is complete (200), refused (its status), or to be waited for (0); -1: gone.
  int look_at(int socket) const;

  struct Visitor {
    process::Handle socket;
    Clock::time_point since;
    std::size_t seen = 0;
  };
  process::Handle socket_;
  std::uint16_t port_;
  std::map<std::uint64_t, Visitor> waiting_{};  ///< in the order in which they came
  std::uint64_t last_ = 0;
};

}  // namespace nonio::live
