// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::host {

/// A process that makes staged results durable while the workers go on. What has come together
/// while the disk was busy is flushed at once, so that a fast night pays for few flushes and a slow
/// one waits for none.
class Committer {
 public:
  struct Done {
    std::size_t campaign = 0;
    std::string error;   ///< empty: stored
    bool again = false;  ///< the process died over it; its parent may store it
  };
  /// Run in the process: stores these campaigns and tells what became of each.
  using Task = std::function<std::vector<Expected<void>>(const std::vector<std::size_t>&)>;

  explicit Committer(Task task) : task_(std::move(task)) {}
  Committer(const Committer&) = delete;
  Committer& operator=(const Committer&) = delete;
  ~Committer();

  /// An error if there is no process for it.
  Expected<void> give(std::size_t campaign);
  /// Those that were given and not answered yet.
  const std::vector<std::size_t>& pending() const { return pending_; }
  /// What is done by now. If the process died: all that was pending.
  std::vector<Done> done();
  int channel() const { return channel_; }  ///< readable when something is done; -1: no process

 private:
  Expected<void> start();
  void end();

  Task task_;
  pid_t pid_ = -1;
  int channel_ = -1;
  std::vector<std::size_t> pending_;
};

}  // namespace nonio::host
