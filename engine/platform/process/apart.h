// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace nonio::process {

/// Continues in a confined child process if `keep_plugins_apart` was called; the parent waits for
/// the child and ends with its status. Further calls do nothing.
void step_aside();

/// Flushes standard output before a fork, because the child would write inherited buffers a second
/// time.
void flush_output();

/// Whether this process is the child of `step_aside`, or a descendant of that child.
bool is_apart();

/// Returns whether a plugin must first be loaded in a trial process. Plugins in the program's own
/// folder are exempt, because they were tested with the program, unless this process cannot be
/// restarted or a previous one ended while it loaded an untried plugin.
bool must_be_tried(const std::filesystem::path& plugin);

/// While an instance exists, this process loads untried plugins. If one of them crashes or hangs,
/// the parent starts another process, which first tries all plugins.
class LoadingUntried {
 public:
  LoadingUntried();
  LoadingUntried(const LoadingUntried&) = delete;
  LoadingUntried& operator=(const LoadingUntried&) = delete;
  ~LoadingUntried();
};

/// Sets the files that plugins cannot read in a confined child. Call it before plugins are loaded.
void hide_from_plugins(std::vector<std::filesystem::path> secrets);

/// In the confined child, standard output goes to standard error during the lifetime of an
/// instance.
class Muted {
 public:
  Muted();
  Muted(const Muted&) = delete;
  Muted& operator=(const Muted&) = delete;
  ~Muted();

 private:
  int output_ = -1;
};

}  // namespace nonio::process
