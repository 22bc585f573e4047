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

/// Returns a new hash. An error if the password does not have 12 to 200 bytes, or contains a
/// control character.
Expected<std::string> password_hash(std::string_view password);
/// Largest product of memory (KiB) and passes of a hash. The hash of a new password has 192 MiB; the
/// limit is five times as much, so that its check takes at most about half a second: no other
/// user can sign in meanwhile.
inline constexpr std::uint32_t most_hash_kibibytes = 1U << 20U;
/// Returns whether the text has the form of a hash that `password_hash` returns, within
/// `most_hash_kibibytes`.
bool is_password_hash(const std::string& text);
/// Whether the password matches the hash. Takes a tenth of a second, even for an empty hash, which
/// matches no password, so that the time does not show whether a user exists. Passwords of more
/// than 200 bytes are rejected at once.
bool fits_password(std::string_view password, const std::string& hash);

}  // namespace nonio::certificates
