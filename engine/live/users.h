// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/storage/json_values.h"

/// Who may do what on the page of a site, where a reverse proxy states who is logged in.
namespace nonio::live {

/// Each may do what those before it may.
enum class Role { view, measure, approve, administer };
/// "view", ...
const char* to_text(Role role);

/// `[[user]]` of SITE/users.toml.
struct User {
  std::string account;  ///< as the proxy states it
  std::string name;     ///< of the person, as documents print it
  Role role = Role::view;
};

inline constexpr const char* users_name = "users.toml";
inline constexpr const char* audit_name = "audit.jsonl";

/// All that is in the text, or the first mistake with its line. No account is given twice, and no
/// two accounts have one name: two signatures are of two persons.
Expected<std::vector<User>> parse_users(std::string_view text);
Expected<std::vector<User>> read_users(const std::filesystem::path& site);

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
