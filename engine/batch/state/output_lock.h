// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Locks an output folder for a run; an error names the process that uses it.
///
/// Two locks are used. flock on OUT/.nonio/lock works among the processes of one host, and on most
/// network file systems among hosts. The file OUT/.nonio/user, created by link(2), names the
/// process that has exclusive use, and works among hosts on every file system with hard links. The
/// file is taken over only if its process is known to have ended: the process belongs to the
/// present boot of this host, where flock decides, or to an earlier boot of this host. Processes of
/// other hosts cannot be checked; `unlock` releases their lock.
class OutputLock {
 public:
  enum class Use {
    whole,    ///< exclusive use; refused also while a run is planned
    planned,  ///< exclusive use; for a process that makes, merges or withdraws a plan
    shard     ///< shared with other shards by flock only, since two processes of the same shard do
              ///< no harm
  };
  static Expected<OutputLock> take(const std::filesystem::path& out, Use use = Use::whole);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  ~OutputLock();

 private:
  explicit OutputLock(int fd) : fd_(fd) {}
  int fd_;
  std::filesystem::path user_{};  ///< path of OUT/.nonio/user; empty if this object does not own
                                  ///< the file
  std::string says_{};            ///< content of the file OUT/.nonio/user as this process wrote it
  long pid_ = 0;                  ///< process id of the owner, so that its child processes do not
                                  ///< remove the file
};

/// Describes the process that has exclusive use of the output folder, for example "process 17 on
/// host a (job 5)"; empty if there is none.
std::string user_of(const std::filesystem::path& out);

/// Removes OUT/.nonio/user of a process that has ended on another host, and returns a description
/// of that process; empty if the file does not exist. `alive` contains the ids of the jobs that a
/// scheduler still runs, one per line. With `alive`, unlocking is refused if the process belongs to
/// one of these jobs, or has no job id (environment variable NONIO_JOB). It is also refused while a
/// process of this host uses the folder.
Expected<std::string> unlock(const std::filesystem::path& out,
                             const std::optional<std::string>& alive);

}  // namespace nonio::batch
