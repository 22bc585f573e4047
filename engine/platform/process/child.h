// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::process {

struct ChildEnd {
  bool well = false;
  std::string words;  ///< reason, such as "signal 11 (Segmentation fault)"; empty if `well`
  bool overdue = false;
};

/// `wait_status` is the status from waitpid.
ChildEnd child_end(int wait_status);

/// Owns a child process with a process group of its own, and kills both at the end of its lifetime.
class Child {
 public:
  struct Settings {
    double memory_MB = 0.0;  ///< limit of the private memory, MB (10^6 bytes); no limit if 0
    /// Whether standard input, output and error of the child are /dev/null. Otherwise, a child that
    /// outlives the parent keeps the parent's output open, so that a reader of this output waits
    /// for the child.
    bool silent = false;
  };
  /// A program and the descriptors of its standard streams; -1 means /dev/null.
  struct Program {
    std::vector<std::string> command;      ///< program path, followed by the arguments
    std::vector<std::string> environment;  ///< entries of the form "NAME=value"
    int input = -1, output = -1, errors = -1;
  };

  Child() = default;
  /// Takes ownership of a child that another process has created for this one.
  explicit Child(pid_t pid);
  /// Runs `work` in a child process, which then exits with status 0 (3 if `work` throws). The child
  /// writes no core file, ends with its parent, and prints to standard error. An error if the
  /// system cannot create a process within two seconds; `purpose` is part of its message, for
  /// example "a process that signs".
  static Expected<Child> start(const std::string& purpose, const Settings& settings,
                               const std::function<void()>& work);
  static Expected<Child> start(const Program& program);
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  Child& operator=(Child&& other) noexcept {
    std::swap(pid_, other.pid_);
    return *this;
  }
  ~Child() { end(); }

  explicit operator bool() const { return pid_ > 0; }
  pid_t pid() const { return pid_; }  ///< process id of the child; -1 without a child
  bool has_ended() const;
  /// Kills the process group of the child and returns how the child ended. A process that waits for
  /// a disk in the kernel is left behind after two seconds. Without a child, the result is `well`.
  ChildEnd end();
  /// Waits up to `seconds` for the child, then kills it and sets `overdue`.
  ChildEnd wait(double seconds);
  void release() { pid_ = -1; }

 private:
  pid_t pid_ = -1;
};

std::vector<pid_t> own_children();
/// Kills all children except `kept`, and their orphans if this process is a subreaper. A process
/// that waits for a disk in the kernel is left behind after two seconds.
void end_children(const std::vector<pid_t>& kept);

/// Prepares a child that `Child::start` did not create: own process group, default signals, no core
/// file, output to standard error. To be called first in that child.
void init_child();
/// Limits the private memory of this process (1 MB = 10^6 bytes). Has no effect under a sanitizer,
/// whose shadow memory exceeds any limit.
void limit_memory(double megabytes);

/// Sets malloc to keep freed memory, because a worker needs it again for the next campaign.
void keep_freed_memory(int reserve_MiB = 1);
/// As `keep_freed_memory`, and asks for pages of 2 MiB for the next 32 MiB of the heap: most time of
/// the system in a short command is for pages of 4 KiB. The process should not fork afterwards.
void use_large_pages();
/// Returns the environment variables as "NAME=value".
std::vector<std::string> present_environment();
/// Returns the number of bytes that malloc has obtained from the system.
std::size_t memory_held();
/// Whether `memory_held` has grown by more than 64 MiB since `at_start`: more than one campaign
/// needs, and too little to affect the next one.
bool has_grown(std::size_t at_start);

}  // namespace nonio::process
