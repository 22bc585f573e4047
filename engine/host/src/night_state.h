// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "nonio/sdk/error.h"

namespace nonio::host {

/// Which night it is. A run that was killed or interrupted is the same night when it is resumed, so
/// that it ends with the same summary as an undisturbed one. Kept in OUT/.nonio.
struct NightState {
  std::uint64_t number = 1;
  bool force = false;
  bool resumed = false;
  std::uint64_t issued_before = 0;  ///< certificates in the register when it began
};

Expected<NightState> begin_night(const std::filesystem::path& out, bool force, bool dry_run,
                                 std::uint64_t issued_so_far);
Expected<void> end_night(const std::filesystem::path& out, const NightState& night);

/// Held while a run uses an output folder; an error names the trouble if another run does.
class OutputLock {
 public:
  static Expected<OutputLock> take(const std::filesystem::path& out);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  ~OutputLock();

 private:
  explicit OutputLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace nonio::host
