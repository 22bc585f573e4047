// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::batch {

/// A process that makes staged results durable while the workers go on. What has accumulated while
/// the disk was busy is flushed at once, so that a fast run needs few flushes and a slow one waits
/// for none.
class Committer {
 public:
  struct Given {
    std::size_t campaign = 0;
    std::uint32_t losses = 0;  ///< of the disk, before its results were written
  };
  struct Done {
    Given given;
    std::string error;   ///< empty: stored
    bool again = false;  ///< the process died over it; its parent may store it
  };
  /// Run in the process: stores these campaigns and reports the outcome of each.
  using Task = std::function<std::vector<Expected<void>>(const std::vector<Given>&)>;

  explicit Committer(Task task) : task_(std::move(task)) {}

  /// An error if there is no process for it.
  Expected<void> give(Given campaign);
  /// Those that were given and not answered yet.
  const std::vector<Given>& pending() const { return pending_; }
  /// Ends the process, whatever it is doing.
  void end();
  /// What is done by now. If the process died: all that was pending.
  std::vector<Done> done();
  int channel() const {
    return channel_.get();
  }  ///< readable when something is done; -1: no process

 private:
  Expected<void> start();

  Task task_;
  process::Handle channel_{};
  process::Child child_{};
  std::vector<Given> pending_;
};

}  // namespace nonio::batch
