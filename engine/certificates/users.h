// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/secret_files.h"
#include "nonio/sdk/error.h"

namespace nonio::config {
struct Key;
}

namespace nonio::certificates {

/// Roles; each includes the rights of those before it.
enum class Role { view, measure, approve, administer };
const char* to_text(Role role);

/// `[[user]]` of users.toml.
struct User {
  std::string account;  ///< as the reverse proxy states it, or the person enters it
  std::string name;     ///< name of the person, as documents print it
  Role role = Role::view;
  std::string password{};  ///< hash (password.h); if empty, no sign-in with a password
};

inline constexpr const char* users_name = config::users_name;

const config::Key& users_file();
/// Returns the first mistake with its line. No account may occur twice, and no two accounts may
/// have the same name, because two approvals must come from two persons.
Expected<std::vector<User>> parse_users(std::string_view text);
/// Whether users.toml exists, even if it cannot be read, for example as a broken symbolic link.
bool has_users(const std::filesystem::path& site);
/// Refuses a file above 1 MB, a symbolic link, and a file that group or others may write, because
/// its writer decides who may approve.
Expected<std::vector<User>> read_users(const std::filesystem::path& site);
std::optional<User> user_with(const std::vector<User>& users, const std::string& account);

}  // namespace nonio::certificates
