// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace nonio::process {

/// Goes on in a child if `keep_plugins_apart` was requested; the first time only.
void step_aside();

/// Whatever a child inherits unwritten, it may write too.
void flush_output();

/// Whether this is such a child, or one of its own.
bool is_apart();

/// Whether a plugin must first be tried in a child of its own: it is not in the folder of the
/// program, with which it was tested, or this process cannot be restarted.
bool must_be_tried(const std::filesystem::path& plugin);

/// While it lives, plugins are loaded that were not tried: what ends this process, or hangs, makes
/// another one that tries all of them first.
class LoadingUntried {
 public:
  LoadingUntried();
  LoadingUntried(const LoadingUntried&) = delete;
  LoadingUntried& operator=(const LoadingUntried&) = delete;
  ~LoadingUntried();
};

/// Where plugins are kept apart: they cannot read these files. Before they are loaded.
void hide_from_plugins(std::vector<std::filesystem::path> secrets);

/// While it lives, standard output is standard error, where plugins are kept apart.
class Muted {
 public:
  Muted();
  Muted(const Muted&) = delete;
  Muted& operator=(const Muted&) = delete;
  ~Muted();

 private:
  int output_ = -1;  ///< -1: nothing to put back
};

}  // namespace nonio::process
