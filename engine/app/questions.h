// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <iostream>
#include <string>

#include "campaign/config/terminal_words.h"
#include "common.h"

namespace nonio::app {

/// Prompts on stderr for values that are empty, with the default in brackets. An empty line, or an
/// object without prompts, gives the default. An error if the input has ended (^D).
class Questions {
 public:
  Questions(bool asks, const config::TerminalWords& words) : say(words), asks_(asks) {}
  static bool on_terminal() { return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1; }
  bool asks() const { return asks_; }
  /// Returns the exit status after an error: interrupted if the input has ended, otherwise usage.
  int status() const { return ended_ ? exit_interrupted : exit_usage; }

  Expected<void> text(const std::string& question, std::string& to, const std::string& otherwise) {
    if (!to.empty()) return {};
    to = otherwise;
    if (!asks_) return {};
    std::cerr << question << (otherwise.empty() ? "" : " [" + otherwise + "]") << ": "
              << std::flush;
    std::string line;
    if (!std::getline(std::cin, line)) {
      ended_ = true;
      std::cerr << "\n";
      return fail("no answer; nothing was written");
    }
    if (!line.empty()) to = line;
    return {};
  }

  const config::TerminalWords& say;

 private:
  bool asks_, ended_ = false;
};

/// Reads a password from the terminal without echo, or one line of standard input. The prompt names
/// the person `whose`.
Expected<std::string> read_password(const std::string& whose);

}  // namespace nonio::app
