// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "platform/process/channel.h"

/// Verbs of this program as processes of their own: what the page of a site does is what a terminal
/// would do.
namespace nonio::live {

/// How a verb ended.
struct ToolEnd {
  int status = -1;          ///< exit status; -1: it did not end by itself
  std::string out, errors;  ///< what it printed; of the errors the end
};

/// In a process of one thread: starts the program with these arguments, sends each line of its
/// errors (and each event of a run) over the channel, and at the end its exit. It terminates the
/// program (SIGTERM) when the other side requests it, and ends it if the other side has ended.
/// `input`: a line for its standard input; empty: it has none. After `seconds` it is terminated, and
/// its exit status is -1.
[[noreturn]] void run_tool(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& input, double seconds, process::Handle channel);

/// The other side: until its end.
ToolEnd hear_tool(const process::Handle& channel,
                  const std::function<void(const std::string& line)>& line);

/// Terminates it: what it has done so far stays whole.
void stop_tool(const process::Handle& channel);

}  // namespace nonio::live
