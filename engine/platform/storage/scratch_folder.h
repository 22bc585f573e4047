// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace nonio::storage {

/// A folder for a moment, of this user alone; removed with the object.
class ScratchFolder {
 public:
  /// Below this folder, or the system's for such (TMPDIR): "nonio-<purpose>-...".
  explicit ScratchFolder(const std::string& purpose, const std::filesystem::path& below = {});
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  /// Empty if it could not be made: nothing may be written then.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace nonio::storage
