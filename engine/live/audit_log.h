// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

#include "nonio/sdk/error.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

inline constexpr const char* audit_name = "audit.jsonl";

/// SITE/audit.jsonl: one line for each request that may change something, also for those that were
/// refused. Lines are only ever added.
class AuditLog {
 public:
  explicit AuditLog(const std::filesystem::path& site) : file_(site / audit_name) {}
  /// With the time, UTC. An error: nothing may be done that would leave no trace.
  Expected<void> write(storage::Json entry);
  /// Empty if there is none.
  Expected<std::string> text() const;

 private:
  std::filesystem::path file_;
  std::mutex mutex_{};
};

}  // namespace nonio::live
