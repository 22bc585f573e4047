// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

#include "nonio/sdk/error.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

inline constexpr const char* audit_name = "audit.jsonl";

/// Appends to SITE/audit.jsonl one line for each request that may change something, including
/// rejected requests.
class AuditLog {
 public:
  explicit AuditLog(const std::filesystem::path& site) : file_(site / audit_name) {}
  /// Adds the time in UTC. After an error, the caller must not carry out the request, because it
  /// would not be recorded.
  Expected<void> write(storage::Json entry);
  /// Returns the content of the file; empty if it does not exist.
  Expected<std::string> text() const;

 private:
  std::filesystem::path file_;
  std::mutex mutex_{};
};

}  // namespace nonio::live
