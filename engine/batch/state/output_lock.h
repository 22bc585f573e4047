// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Held while a run uses an output folder; an error names who else does.
///
/// Two locks. flock on OUT/.nonio/lock holds among the processes of one host, and on most network
/// file systems among hosts. OUT/.nonio/user, made by link(2), names the process that uses the
/// folder for itself, and holds among hosts wherever a file can have two names. It is taken over
/// only if its process is known to have ended: the same start of this host, where flock decides, or
/// an earlier start of this host. Of another host this is unknown here: `unlock` states it.
class OutputLock {
 public:
  enum class Use {
    whole,    ///< refused while a run is planned, too
    planned,  ///< makes, merges or withdraws a plan
    shard     ///< together with other shards: flock only, since two of the same shard are harmless
  };
  static Expected<OutputLock> take(const std::filesystem::path& out, Use use = Use::whole);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  ~OutputLock();

 private:
  explicit OutputLock(int fd) : fd_(fd) {}
  int fd_;
  std::filesystem::path user_{};  ///< OUT/.nonio/user; empty if this does not own it
  std::string says_{};            ///< its bytes
  long pid_ = 0;                  ///< of the owner: no process that it starts removes the file
};

/// Who uses the folder for itself now, for people: "process 17 on host a (job 5)"; empty if no process does.
std::string user_of(const std::filesystem::path& out);

/// Frees a folder whose process, on another host, is known to have ended; gives who it was, nothing
/// if there was none. With `alive`, the jobs that a scheduler still has, a job in each line:
/// refused if the user is of one of them, or of no job (NONIO_JOB of its environment). Refused
/// while a process of this host uses the folder.
Expected<std::string> unlock(const std::filesystem::path& out,
                             const std::optional<std::string>& alive);

}  // namespace nonio::batch
