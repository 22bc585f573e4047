// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"

namespace nonio::batch {

/// Makes staged results durable in a child process while the workers continue. All campaigns that
/// were queued while the disk was busy, up to 64, are flushed together; a batch never waits for
/// more campaigns.
class Committer {
 public:
  struct Given {
    std::size_t campaign = 0;
    /// Number of lost writes that the disk had reported before the results were written.
    std::uint32_t losses = 0;
  };
  struct Done {
    Given given;
    std::string error;  ///< reason of a failure; empty if the results are stored
    /// Whether the process ended before an answer, so that the caller may store the campaign.
    bool again = false;
  };
  /// Runs in the child process and returns one result per campaign.
  using Task = std::function<std::vector<Expected<void>>(const std::vector<Given>&)>;

  explicit Committer(Task task) : task_(std::move(task)) {}

  /// Queues a campaign. An error if the process cannot be started.
  Expected<void> give(Given campaign);
  const std::vector<Given>& pending() const { return pending_; }
  /// Ends the process at once, even during a write.
  void end();
  /// Returns the campaigns that were finished since the last call. If the process has ended, all
  /// pending campaigns are returned.
  std::vector<Done> done();
  int channel() const {
    return channel_.get();
  }  ///< readable when a campaign is finished; -1 without a process

 private:
  Expected<void> start();

  Task task_;
  process::Handle channel_{};
  process::Child child_{};
  std::vector<Given> pending_;
};

}  // namespace nonio::batch
