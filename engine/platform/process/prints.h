// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "platform/process/channel.h"

namespace nonio::batch {

/// Collects what plugins print in this process until it is known which plugin printed it. At most
/// 64 KiB are kept between two calls of `pass_on`.
class Prints {
 public:
  /// Replaces standard output and error of the process. `pass_on` writes to the descriptor `to`.
  explicit Prints(int to);
  bool valid() const { return static_cast<bool>(reading_); }
  /// Returns the descriptor of the collected text, which another process can read after this one
  /// has died.
  int reading() const { return reading_.get(); }
  /// Passes on what was printed since the last call, preceded by the name `who`.
  void pass_on(const std::string& who);

 private:
  int to_;
  process::Handle reading_{};
};

/// Reads everything that a non-blocking pipe contains.
std::string take_all(int pipe);

/// Returns "WHO prints: TEXT" with a line feed at the end; "a plugin" if `who` is empty.
std::string printed_by(const std::string& who, std::string_view text);

}  // namespace nonio::batch
