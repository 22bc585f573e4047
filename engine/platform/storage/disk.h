// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// The file system of the output folder, for the processes of one run. The kernel reports a lost
/// write once, and only to descriptors that were open at the time: so this is made before the first
/// process that writes, and all of them share it.
class Disk {
 public:
  explicit Disk(const std::filesystem::path& folder);
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  ~Disk();

  /// Returns when everything that was written is on disk; an error if the disk lost a write since
  /// the last call.
  Expected<void> flush() const;
  /// How often it did, in any process. What was begun at another count is not reliable, because it
  /// is not known which writes were lost.
  std::uint32_t losses() const { return losses_ == nullptr ? 0 : losses_->load(); }

 private:
  std::filesystem::path folder_;
  int fd_ = -1;
  int trouble_ = 0;  ///< errno of why there is no descriptor or counter
  std::atomic<std::uint32_t>* losses_ = nullptr;  ///< shared by the processes
};

}  // namespace nonio::storage
