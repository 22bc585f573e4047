// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "platform/process/channel.h"

namespace nonio::batch {

/// In a process with plugins: what they print, kept back until it is known who did. Of what they
/// print at once, 64 kB are kept.
class Prints {
 public:
  /// Takes the place of standard output and error; `to`: where it is passed on.
  explicit Prints(int to);
  bool valid() const { return static_cast<bool>(reading_); }
  /// The end that another process may read when this one has died.
  int reading() const { return reading_.get(); }
  /// Passes on what was printed since the last call, with who did in front.
  void pass_on(const std::string& who);

 private:
  int to_;
  process::Handle reading_{};
};

/// All that is in a pipe that does not wait.
std::string take_all(int pipe);

/// "WHO prints: TEXT", a line of its own.
std::string printed_by(const std::string& who, std::string_view text);

}  // namespace nonio::batch
