// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

/// SITE/users.toml: who may do what on the page of a site, and who has approved a certificate.
namespace nonio::certificates {

/// Each may do what those before it may.
enum class Role { view, measure, approve, administer };
/// "view", ...
const char* to_text(Role role);

/// `[[user]]` of users.toml.
struct User {
  std::string account;  ///< as the reverse proxy states it, or as the person types it
  std::string name;     ///< of the person, as documents print it
  Role role = Role::view;
  std::string password{};  ///< hash of it (password.h); empty: no sign-in with a password
};

inline constexpr const char* users_name = "users.toml";

/// All that is in the text, or the first mistake with its line. No account is given twice, and no
/// two accounts have one name: two signatures are of two persons.
Expected<std::vector<User>> parse_users(std::string_view text);
/// A link, or more than a megabyte, is refused.
Expected<std::vector<User>> read_users(const std::filesystem::path& site);
/// The one with this account; none: it is no user.
std::optional<User> user_with(const std::vector<User>& users, const std::string& account);

}  // namespace nonio::certificates
