// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/template_files.h"

namespace nonio::config {

/// site.toml of a site, if there is one; every error with its line.
Checked<SiteFile> read_site(const std::filesystem::path& site, std::string& digest);

/// The site's own files that hold for all its campaigns, as they are read.
struct SiteFiles {
  std::optional<std::string> settings{};  ///< site.toml; none: there is no such file
  TemplateFiles templates{};
};

/// `reading` is called with each path before it is read.
Expected<SiteFiles> read_site_files(
    const std::filesystem::path& site,
    const std::function<void(const std::filesystem::path&)>& reading);

/// The same from files that were read.
Checked<SiteFile> site_in(const SiteFiles& files, std::string& digest);

/// `folders`, then the site's own templates and causes if it has some.
Expected<std::vector<std::filesystem::path>> with_site_templates(
    std::vector<std::filesystem::path> folders, const std::filesystem::path& site);

std::string to_hex(std::string_view bytes);
Expected<std::string> from_hex(const std::string& text);

/// The nearest folder at or above the campaign that holds a site.toml, else one with records of
/// machines, else one with causes; else the campaign's own.
std::filesystem::path site_of(const std::filesystem::path& campaign);

}  // namespace nonio::config
