// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "live/calculation.h"
#include "platform/process/channel.h"

namespace nonio::live {

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
