// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/site_files.h"
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
  std::string password{};  ///< hash; if empty, no sign-in with a password
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

/// Passwords of users.toml: Argon2id (RFC 9106) with 64 MiB, three passes and a salt of 128 bits,
/// as "$argon2id$v=19$m=65536,t=3,p=1$salt$hash".
inline constexpr std::size_t shortest_password = 12, longest_password = 200;

/// Returns an error unless the password has 12 to 200 bytes and no control characters.
Expected<std::string> password_hash(std::string_view password);
/// Largest product of memory (KiB) and passes of a hash, about five times that of a new hash (192
/// MiB). Its check takes about half a second, in which no other user can sign in.
inline constexpr std::uint32_t most_hash_kibibytes = 1U << 20U;
/// Whether the text is an Argon2id hash within `most_hash_kibibytes`.
bool is_password_hash(const std::string& text);
/// Takes about 0.1 s even for an empty hash, which matches no password, so that the time does not
/// show whether a user exists. Passwords of more than 200 bytes are rejected at once.
bool fits_password(std::string_view password, const std::string& hash);

/// Returns the mistake in the name of a person who approves; empty if the name is valid: one line
/// of up to 100 bytes without invisible characters, without compatibility characters (NFKC), and
/// without words that mix letters of two alphabets.
std::string mistake_in_name(const std::string& name);

/// Returns the letters and digits in lower case, with letters of other alphabets replaced by the
/// Latin letters that they resemble. Two names with the same result count as one person.
std::string likeness_of(const std::string& name);

}  // namespace nonio::certificates
