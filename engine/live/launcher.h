// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "live/calculation.h"
#include "platform/process/channel.h"

namespace nonio::live {

/// Makes processes for a server that has threads and so must not fork: a process of one
/// thread, made before the first thread.
class Launcher {
 public:
  /// Ends with this process.
  static Expected<Launcher> start(const BenchWish& common);

  /// A new bench process for this campaign: the channel to it.
  Expected<process::Handle> open(const std::filesystem::path& campaign);
  /// This program with other arguments (tool.h): the channel to it. `input`: a line that it reads.
  Expected<process::Handle> run(const std::vector<std::string>& arguments, double seconds,
                                const std::string& input = {});

 private:
  Expected<process::Handle> ask(const storage::Json& what);
  explicit Launcher(process::Handle channel) : channel_(std::move(channel)) {}

  process::Handle channel_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
};

}  // namespace nonio::live
