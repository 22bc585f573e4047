// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Locks an output folder for a run; an error names the process that uses it.
/// flock on OUT/.nonio/lock excludes processes of one host, and on most network file systems of
/// other hosts. The file OUT/.nonio/user, created by link(2), excludes processes of all hosts on
/// file systems with hard links. A file of this host is taken over if its process has ended: in the
/// present boot flock proves this, in an earlier boot the restart. Files of other hosts must be
/// removed by `unlock`.
class OutputLock {
 public:
  enum class Use {
    whole,    ///< exclusive; refused while a run is planned
    planned,  ///< exclusive; for a process that makes, merges or withdraws a plan
    shard     ///< shared by flock among shards
  };
  static Expected<OutputLock> take(const std::filesystem::path& out, Use use = Use::whole);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  ~OutputLock();

 private:
  explicit OutputLock(int fd) : fd_(fd) {}
  int fd_;
  std::filesystem::path user_{};  ///< OUT/.nonio/user; empty if this object did not create the file
  std::string says_{};            ///< content of the file `user_`
  /// Process that created the file, because its child processes must not remove it.
  long pid_ = 0;
};

/// Returns, for example, "process 17 on host a (job 5)"; empty if no process has exclusive use.
std::string user_of(const std::filesystem::path& out);

/// Removes OUT/.nonio/user of a process that has ended on another host and returns the description
/// of the process; empty if the file does not exist. `alive` lists the jobs of a scheduler, one id
/// per line: an error if the job of the process (NONIO_JOB) is listed or unknown. An error also if
/// a process has the flock.
Expected<std::string> unlock(const std::filesystem::path& out,
                             const std::optional<std::string>& alive);

}  // namespace nonio::batch
