// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::process {

/// A file descriptor that is closed at the end; -1: none.
class Handle {
 public:
  Handle() = default;
  explicit Handle(int fd) : fd_(fd) {}
  Handle(Handle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Handle();
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// Both ends of a channel between two processes, closed when another program is started.
/// `type`: SOCK_STREAM or SOCK_SEQPACKET.
Expected<std::array<Handle, 2>> channel_pair(int type, const std::string& to_whom);

/// Length, then bytes, over a stream. False if the other side has ended; `read` also if it sends
/// more than the limit.
bool write_text(int stream, std::string_view bytes);
bool read_text(int stream, std::string& bytes);

/// A byte and some descriptors with it, over any channel. False if the other side has ended.
bool send_descriptors(int channel, char word, const std::vector<int>& descriptors);

struct Received {
  char word = 0;
  std::vector<Handle> descriptors;  ///< closed when another program is started
  pid_t sender = -1;                ///< as the kernel knows it; -1 where SO_PASSCRED is not set
};
/// An error if the other side has ended.
Expected<Received> receive_descriptors(int channel);

}  // namespace nonio::process
