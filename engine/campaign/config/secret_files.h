// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

/// The file of a site with its users and the hashes of their passwords.
inline constexpr const char* users_name = "users.toml";

/// Returns all files that contain keys, passwords or their hashes, in the site and in systemd's
/// credentials.
std::vector<std::filesystem::path> secret_files(const SiteFile& file,
                                                const std::filesystem::path& site);

/// Returns an error if other users have access to a file, because they could use its key or
/// password. The message names the file `what`, for example "the signing key".
Expected<void> check_secret(const std::filesystem::path& path, const std::string& what);

/// The source of a password. Exactly one of `file`, `env` and `credential` is not empty.
struct PasswordSource {
  const std::string &file, &env, &credential;
  std::string what;     ///< name of the password in messages: "the key's password"
  std::string section;  ///< section of site.toml that states the source
};

/// Reads a password from its source. Line ends at the end of a file or credential are removed; the
/// value of an environment variable is returned unchanged.
Expected<std::string> read_password(const PasswordSource&, const std::filesystem::path& site);

}  // namespace nonio::config
