// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Passwords of users.toml: Argon2id (RFC 9106) with 64 MiB, three passes and a salt of 128 bits,
/// as "$argon2id$v=19$m=65536,t=3,p=1$salt$hash".
namespace nonio::certificates {

inline constexpr std::size_t shortest_password = 12, longest_password = 200;

/// A new hash. An error if the password has not 12 to 200 bytes or a control character.
Expected<std::string> password_hash(std::string_view password);
/// Whether a text has the form of such a hash; one that would take more than 1 GiB has not.
bool is_password_hash(const std::string& text);
/// Takes a tenth of a second, also for an empty hash, which fits no password: the time does not
/// show whether a user exists.
bool fits_password(std::string_view password, const std::string& hash);

}  // namespace nonio::certificates
