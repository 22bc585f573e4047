// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/process/channel.h"

/// Runs commands of this program in processes of their own, so that the page of a site does the
/// same as a terminal.
namespace nonio::live {

/// Result of a command.
struct ToolEnd {
  int status = -1;          ///< exit status; -1: the command did not end by itself
  std::string out, errors;  ///< standard output, and the end of the error output
};

/// Runs the program with these arguments in a process with one thread. Sends each line of its error
/// output (and each event of a run) over the channel, and its exit at the end. The program is
/// terminated by SIGTERM on request and after `seconds`, and killed 10 s later than `seconds`, or
/// when the other side has ended. After `seconds` the exit status is -1. `input`: a line for its
/// standard input; empty: none.
[[noreturn]] void run_tool(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& input, double seconds, process::Handle channel);

/// Runs the program in this process, with `channel` as its standard input and output. It ends when
/// the other side closes the channel.
[[noreturn]] void run_partner(const std::string& program, const std::vector<std::string>& arguments,
                              process::Handle channel);

/// Sends a line to a program that `run_partner` runs, and returns the line that it prints. None if
/// the program has ended, or if it printed nothing for `seconds`.
std::optional<std::string> ask_partner(const process::Handle& channel, const std::string& line,
                                       double seconds);

/// Receives what `run_tool` sends, and calls `line` for each line, until the program has ended.
ToolEnd hear_tool(const process::Handle& channel,
                  const std::function<void(const std::string& line)>& line);

/// Requests that the program is terminated by SIGTERM; finished work is kept.
void stop_tool(const process::Handle& channel);

}  // namespace nonio::live
