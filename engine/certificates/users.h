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

/// Reads SITE/users.toml: the users of a site's page and their roles, and the persons who approve
/// certificates.
namespace nonio::certificates {

/// Roles; each includes the rights of those before it.
enum class Role { view, measure, approve, administer };
/// Returns "view", "measure", "approve" or "administer".
const char* to_text(Role role);

/// `[[user]]` of users.toml.
struct User {
  std::string account;  ///< account, as the reverse proxy states it or as the person enters it
  std::string name;     ///< name of the person, as documents print it
  Role role = Role::view;
  std::string password{};  ///< hash of the password (password.h); empty: the user cannot sign in
                           ///< with a password
};

inline constexpr const char* users_name = config::users_name;

/// Returns the declaration of the file.
const config::Key& users_file();
/// Parses users.toml; an error states the first mistake with its line. No account may occur twice,
/// and no two accounts may have the same name, because two approvals must come from two persons.
Expected<std::vector<User>> parse_users(std::string_view text);
/// Whether the site has a file with users, also one that cannot be read, for example a link that
/// leads nowhere.
bool has_users(const std::filesystem::path& site);
/// Reads the file of a site. Refused: a file above 1 MB, a symbolic link, and a file that group or
/// others may write, because its writer decides who may approve.
Expected<std::vector<User>> read_users(const std::filesystem::path& site);
/// Returns the user with this account; none if there is no such user.
std::optional<User> user_with(const std::vector<User>& users, const std::string& account);

}  // namespace nonio::certificates
