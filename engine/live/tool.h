// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "live/calculation.h"
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

/// A process with one thread that starts processes for the server, which has threads and therefore
/// must not fork. It must be made before the first thread.
class Launcher {
 public:
  /// The launcher ends with this process.
  static Expected<Launcher> start(const BenchWish& common);

  /// Starts a bench process for this campaign and returns the channel to it.
  Expected<process::Handle> open(const std::filesystem::path& campaign);
  /// Runs this program with other arguments (tool.h), terminates it after `seconds` (s), and
  /// returns the channel to it. `input` is a line for standard input.
  Expected<process::Handle> run(const std::vector<std::string>& arguments, double seconds,
                                const std::string& input = {});
  /// Runs this program with `run_partner` (tool.h) and returns the channel to it.
  Expected<process::Handle> partner(const std::vector<std::string>& arguments);

 private:
  Expected<process::Handle> ask(const storage::Json& what);
  explicit Launcher(process::Handle channel) : channel_(std::move(channel)) {}

  process::Handle channel_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
};

}  // namespace nonio::live
