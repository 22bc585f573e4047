// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

/// File of a site with users and the hashes of their passwords.
inline constexpr const char* users_name = "users.toml";

/// Returns all files with keys, passwords or their hashes, in the site and in systemd's
/// credentials.
std::vector<std::filesystem::path> secret_files(const SiteFile& file,
                                                const std::filesystem::path& site);

/// Returns an error if other users can access the file. `what`: subject of the message.
Expected<void> check_secret(const std::filesystem::path& path, const std::string& what);

/// Exactly one of `file`, `env` and `credential` is not empty.
struct PasswordSource {
  const std::string &file, &env, &credential;
  std::string what;
  std::string section;
};

/// Line ends are removed from the end of files and credentials, not of environment variables.
Expected<std::string> read_password(const PasswordSource&, const std::filesystem::path& site);

}  // namespace nonio::config
