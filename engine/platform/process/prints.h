// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "platform/process/channel.h"

namespace nonio::batch {

/// Buffers the output of plugins in this process until the plugin that printed it is known. At most
/// 64 KiB are kept between two calls of `pass_on`.
class Prints {
 public:
  /// Redirects standard output and standard error; `pass_on` writes to the descriptor `to`.
  explicit Prints(int to);
  bool valid() const { return static_cast<bool>(reading_); }
  /// Descriptor of the buffered text, which another process can read after this one has ended.
  int reading() const { return reading_.get(); }
  /// Writes what was printed since the last call, preceded by the plugin's name `who`.
  void pass_on(const std::string& who);

 private:
  int to_;
  process::Handle reading_{};
};

/// The pipe must be non-blocking.
std::string take_all(int pipe);

/// Returns "WHO prints: TEXT" with a line feed at the end; an empty `who` becomes "a plugin".
std::string printed_by(const std::string& who, std::string_view text);

}  // namespace nonio::batch
