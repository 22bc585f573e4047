// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace nonio::storage {

/// A temporary folder that only this user can read; it is removed at the end of the lifetime.
class ScratchFolder {
 public:
  /// Creates "nonio-<purpose>-..." in `below`; if this is empty, in the system's temporary folder
  /// (TMPDIR).
  explicit ScratchFolder(const std::string& purpose, const std::filesystem::path& below = {});
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  /// Empty if the folder could not be created.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace nonio::storage
