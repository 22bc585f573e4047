// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::process {

/// What became of a child process.
struct ChildEnd {
  bool well = false;  ///< it exited with 0
  std::string words;  ///< else: "signal 11 (Segmentation fault)", "exit status 3"
  bool overdue = false;
};

/// From the status of waitpid.
ChildEnd child_end(int wait_status);

/// A child process with a process group of its own, which is killed at the end. Moved, not copied.
class Child {
 public:
  struct Settings {
    double memory_MB = 0.0;  ///< private memory from now on; none if 0
    /// It prints nothing: a reader of the parent's output waits until every process has closed it,
    /// also a child that outlives the parent.
    bool silent = false;
  };
  /// A program in the child; descriptors of the parent, -1: nothing.
  struct Program {
    std::vector<std::string> command;      ///< the first is its path
    std::vector<std::string> environment;  ///< "NAME=value"
    int input = -1, output = -1, errors = -1;
  };

  Child() = default;
  /// One that another process made for this one.
  explicit Child(pid_t pid);
  /// Does `work` in a child, which then ends with status 0. It has no core file, ends with its
  /// parent, and its standard output is the standard error, so that results stay clean. An error
  /// if the system has no process for `purpose`, "a process that signs", within two seconds.
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
  pid_t pid() const { return pid_; }  ///< -1: none
  bool has_ended() const;
  /// Kills it with its process group. One that waits for a disk in the kernel ends when the disk
  /// answers: after two seconds it is left to itself. Well if there is none.
  ChildEnd end();
  /// Waits up to `seconds`, then kills it.
  ChildEnd wait(double seconds);
  /// It goes on alone, until this process ends.
  void release() { pid_ = -1; }

 private:
  pid_t pid_ = -1;
};

std::vector<pid_t> own_children();
/// Ends all but these, and whatever they leave where this process is a subreaper. One that waits
/// for a disk in the kernel is left behind.
void end_children(const std::vector<pid_t>& kept);

/// To be called first in a child that `Child::start` did not make.
void init_child();
/// Private memory that the process may have from now on. Without effect under a sanitizer, whose
/// shadow memory is larger than any limit.
void limit_memory(double megabytes);

/// Memory that a worker gives back to the system would only be faulted in again for the next
/// campaign.
void keep_freed_memory();
/// "NAME=value" of all variables.
std::vector<std::string> present_environment();
/// Bytes that the process has from the system for its data.
std::size_t memory_held();
/// Whether that has become noticeably more: more than the tables and reports of a campaign need,
/// far less than would hurt the next one.
bool has_grown(std::size_t at_start);

}  // namespace nonio::process
