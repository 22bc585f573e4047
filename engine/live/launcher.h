// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "live/calculation.h"
#include "platform/process/channel.h"

namespace nonio::live {

/// Starts processes for the server, which has threads and so must not fork. The launcher is a
/// process with one thread that is made before the first thread.
class Launcher {
 public:
  /// Starts the launcher; it ends with this process.
  static Expected<Launcher> start(const BenchWish& common);

  /// Starts a bench process for this campaign and returns the channel to it.
  Expected<process::Handle> open(const std::filesystem::path& campaign);
  /// Runs this program with other arguments (tool.h) and returns the channel to it. The program is
  /// terminated after `seconds` (s). `input`: a line for its standard input.
  Expected<process::Handle> run(const std::vector<std::string>& arguments, double seconds,
                                const std::string& input = {});
  /// Runs this program as a partner (tool.h), which answers until the returned channel is closed.
  Expected<process::Handle> partner(const std::vector<std::string>& arguments);

 private:
  Expected<process::Handle> ask(const storage::Json& what);
  explicit Launcher(process::Handle channel) : channel_(std::move(channel)) {}

  process::Handle channel_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
};

}  // namespace nonio::live
