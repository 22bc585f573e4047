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

/// Owns a file descriptor; -1 means that there is none.
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

/// Creates a socket pair of type SOCK_STREAM or SOCK_SEQPACKET with FD_CLOEXEC. `to_whom` names the
/// partner in an error message.
Expected<std::array<Handle, 2>> channel_pair(int type, const std::string& to_whom);

/// `write_text` and `read_text` transfer a text preceded by its length. They return false if the
/// other process has ended; `read_text` also if the text is longer than 1 GiB.
bool write_text(int stream, std::string_view bytes);
bool read_text(int stream, std::string& bytes);

/// Sends a byte and up to four descriptors. Returns false if there are more descriptors, or if the
/// other process has ended.
bool send_descriptors(int channel, char word, const std::vector<int>& descriptors);

struct Received {
  char word = 0;
  /// Received descriptors, with FD_CLOEXEC.
  std::vector<Handle> descriptors;
  pid_t sender = -1;  ///< process id from the kernel; -1 unless SO_PASSCRED is set
};
/// Receives what `send_descriptors` sent. An error if the other process has ended.
Expected<Received> receive_descriptors(int channel);

}  // namespace nonio::process
