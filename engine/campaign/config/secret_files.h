// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

/// The files in which keys and passwords lie, wherever they are.
std::vector<std::filesystem::path> secret_files(const SiteFile& file,
                                                const std::filesystem::path& site);

/// Whoever can read a key or a password can use it. `what`: "the signing key".
Expected<void> check_secret(const std::filesystem::path& path, const std::string& what);

/// From where a password comes: exactly one of these.
struct PasswordSource {
  const std::string &file, &env, &credential;
  std::string what;     ///< "the key's password"
  std::string section;  ///< of site.toml
};

/// Without the end of its line.
Expected<std::string> read_password(const PasswordSource&, const std::filesystem::path& site);

}  // namespace nonio::config
