// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/process/channel.h"

/// Runs commands of this program in separate processes, so that the page of a site has the same
/// effect as a terminal.
namespace nonio::live {

struct ToolEnd {
  int status = -1;
  std::string out, errors;  ///< standard output, and the end of the error output
};

/// Runs the program in a process with one thread. Sends each line of its error output (and each
/// event of a run) over the channel, then its exit. The program is terminated by SIGTERM on request
/// and after `seconds`, and killed 10 s later or when the other side has ended. After `seconds` the
/// exit status is -1. `input` is a line for standard input, if not empty.
[[noreturn]] void run_tool(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& input, double seconds, process::Handle channel);

/// Replaces this process by the program, with `channel` as standard input and output.
[[noreturn]] void run_partner(const std::string& program, const std::vector<std::string>& arguments,
                              process::Handle channel);

/// Sends a line to a program that `run_partner` runs, and returns the line that it prints.
/// std::nullopt if the program has ended or has printed nothing for `seconds`.
std::optional<std::string> ask_partner(const process::Handle& channel, const std::string& line,
                                       double seconds);

/// Receives the output of `run_tool` and calls `line` for each line until the program has ended.
ToolEnd hear_tool(const process::Handle& channel,
                  const std::function<void(const std::string& line)>& line);

/// Terminates the program by SIGTERM; finished work is kept.
void stop_tool(const process::Handle& channel);

}  // namespace nonio::live
