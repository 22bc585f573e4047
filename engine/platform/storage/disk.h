// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// Detects lost writes on the file system of the output folder. The kernel reports a lost write
/// only once, and only to descriptors that were open at that time. Therefore an instance is created
/// before the first process that writes, and is shared by all processes of the run.
class Disk {
 public:
  explicit Disk(const std::filesystem::path& folder);
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  ~Disk();

  /// Flushes the file system. An error, for example, if the disk has lost a write since the last
  /// call.
  Expected<void> flush() const;
  /// Number of failed flushes in all processes. If it changes during a work step, the step is not
  /// reliable, because it is not known which writes were lost.
  std::uint32_t losses() const { return losses_ == nullptr ? 0 : losses_->load(); }

 private:
  std::filesystem::path folder_;
  int fd_ = -1;
  int trouble_ = 0;  ///< errno if a descriptor or counter cannot be created
  std::atomic<std::uint32_t>* losses_ = nullptr;
};

}  // namespace nonio::storage
