// SPDX-License-Identifier: Apache-2.0
#include "questions.h"

#include <termios.h>
#include <unistd.h>

#include <iostream>

namespace nonio::app {

namespace {

class Hidden {
 public:
  Hidden() {
    on_ = ::tcgetattr(STDIN_FILENO, &before_) == 0;
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    if (on_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &now);
  }
  Hidden(const Hidden&) = delete;
  Hidden& operator=(const Hidden&) = delete;
  ~Hidden() {
    if (on_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
  }

 private:
  termios before_{};
  bool on_ = false;
};

}  // namespace

Expected<std::string> read_password(const std::string& whose) {
  std::string line;
  const bool asks = Questions::on_terminal();
  if (asks) std::cerr << "Password of " << whose << ": " << std::flush;
  const bool is_there = [&] {
    if (!asks) return static_cast<bool>(std::getline(std::cin, line));
    const Hidden hidden;
    return static_cast<bool>(std::getline(std::cin, line));
  }();
  if (asks) std::cerr << "\n";
  if (!is_there) return fail("no password: expected it from the terminal or on standard input");
  return line;
}

}  // namespace nonio::app
