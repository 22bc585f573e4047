// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace nonio::process {

/// Continues in a confined child process if `keep_plugins_apart` was called; further calls do
/// nothing. The parent waits for the child and ends with its status.
void step_aside();

/// Writes all buffered standard output, because a child would inherit the buffers and write them a
/// second time.
void flush_output();

/// Whether this process is the child of `step_aside`, or a descendant of that child.
bool is_apart();

/// Returns whether a plugin must first be loaded in a trial process. This is the case unless it is
/// in the program's own folder, whose plugins were tested with the program. It is also the case if
/// this process cannot be restarted, or if a process has ended before while it loaded an untried
/// plugin.
bool must_be_tried(const std::filesystem::path& plugin);

/// States that this process loads plugins that were not tried, during the lifetime of the object.
/// If one of them ends this process or hangs, the parent starts another process, which tries all
/// plugins first.
class LoadingUntried {
 public:
  LoadingUntried();
  LoadingUntried(const LoadingUntried&) = delete;
  LoadingUntried& operator=(const LoadingUntried&) = delete;
  ~LoadingUntried();
};

/// Sets the files that plugins cannot read if they run in a confined child. Call it before plugins
/// are loaded.
void hide_from_plugins(std::vector<std::filesystem::path> secrets);

/// Redirects standard output to standard error during its lifetime, if this process is the confined
/// child for plugins.
class Muted {
 public:
  Muted();
  Muted(const Muted&) = delete;
  Muted& operator=(const Muted&) = delete;
  ~Muted();

 private:
  int output_ = -1;  ///< copy of standard output; -1: nothing to restore
};

}  // namespace nonio::process
