// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/template_files.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

namespace nonio::config {

/// Returns defaults without site.toml. `digest` receives the SHA-256 of the file.
Checked<SiteFile> read_site(const std::filesystem::path& site, std::string& digest);

struct SiteFiles {
  std::optional<std::string> settings{};  ///< text of site.toml; nullopt if the file does not exist
  TemplateFiles templates{};
};

/// Calls `reading` with each path before the file is read.
Expected<SiteFiles> read_site_files(
    const std::filesystem::path& site,
    const std::function<void(const std::filesystem::path&)>& reading);

/// `digest` receives the SHA-256 of site.toml.
Checked<SiteFile> site_in(const SiteFiles& files, std::string& digest);

/// Returns `folders`, followed by the site's own templates and causes if they exist.
Expected<std::vector<std::filesystem::path>> with_site_templates(
    std::vector<std::filesystem::path> folders, const std::filesystem::path& site);

std::string to_hex(std::string_view bytes);
Expected<std::string> from_hex(const std::string& text);

/// Returns the nearest folder at or above the campaign with site.toml, otherwise with machines/,
/// otherwise with causes/, otherwise the campaign's folder.
std::filesystem::path site_of(const std::filesystem::path& campaign);

/// `list`: paths separated by commas, for example "a.ini,b.ini".
Expected<std::vector<Artifact>> read_table_files(const std::string& list);
/// `list`: paths inside `base`, separated by commas. Each file has at most 1 MB.
Expected<std::vector<Artifact>> read_table_files(const std::string& list,
                                                 const std::filesystem::path& base);

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
