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

/// Makes staged results durable in a child process while the workers continue. Up to 64 campaigns
/// that were given while the disk was busy are flushed together, so that the number of flushes
/// remains small without delaying a single campaign.
class Committer {
 public:
  struct Given {
    std::size_t campaign = 0;
    std::uint32_t losses = 0;  ///< number of losses that the disk had reported before the results
                               ///< were written
  };
  struct Done {
    Given given;
    std::string error;   ///< reason why the results could not be stored; empty: they are stored
    bool again = false;  ///< whether the process died while storing the campaign, so that the
                         ///< parent process may store it
  };
  /// Runs in the child process: stores these campaigns and returns the outcome of each.
  using Task = std::function<std::vector<Expected<void>>(const std::vector<Given>&)>;

  explicit Committer(Task task) : task_(std::move(task)) {}

  /// Queues a campaign. An error if the process cannot be started.
  Expected<void> give(Given campaign);
  /// Returns the campaigns that were given and not answered yet.
  const std::vector<Given>& pending() const { return pending_; }
  /// Ends the process at once, even while it writes.
  void end();
  /// Returns the campaigns that are finished since the last call. If the process died, all pending
  /// ones are returned.
  std::vector<Done> done();
  int channel() const {
    return channel_.get();
  }  ///< descriptor that can be read when a campaign is finished; -1: the process is not running

 private:
  Expected<void> start();

  Task task_;
  process::Handle channel_{};
  process::Child child_{};
  std::vector<Given> pending_;
};

}  // namespace nonio::batch
