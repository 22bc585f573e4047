// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Passwords of users.toml: Argon2id (RFC 9106) with 64 MiB, three passes and a salt of 128 bits,
/// as "$argon2id$v=19$m=65536,t=3,p=1$salt$hash".
namespace nonio::certificates {

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

}  // namespace nonio::certificates
