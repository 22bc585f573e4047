// SPDX-License-Identifier: Apache-2.0
#include "platform/process/prints.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <iostream>

namespace nonio::batch {

Prints::Prints(int to) : to_(to) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  reading_ = process::Handle(ends[0]);
  const process::Handle writing(ends[1]);
  ::dup2(writing.get(), STDOUT_FILENO);
  ::dup2(writing.get(), STDERR_FILENO);
}

void Prints::pass_on(const std::string& who) {
  std::cout.flush();
  std::fflush(stdout);
  const std::string text = take_all(reading_.get());
  if (text.empty()) return;
  const std::string named = printed_by(who, text);
  [[maybe_unused]] const ssize_t n = ::write(to_, named.data(), named.size());
}

std::string take_all(int pipe) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t n = 0; (n = ::read(pipe, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(n));
  return text;
}

std::string printed_by(const std::string& who, std::string_view text) {
  return (who.empty() ? "a plugin" : who) + " prints: " + std::string(text) +
         (text.ends_with('\n') ? "" : "\n");
}

}  // namespace nonio::batch
