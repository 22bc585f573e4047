// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"

namespace nonio::config {

/// Templates that were already read: bytes by path below the folder.
struct TemplateFiles {
  std::filesystem::path folder{};
  std::map<std::string, std::string> files{};
};

/// Returns every file below a folder by its path relative to the folder; links to folders are
/// followed.
Expected<std::map<std::string, std::filesystem::path>> template_paths(
    const std::filesystem::path& folder);

/// Reads template folders: a file of a later folder replaces the same file of earlier ones, and
/// files in `own` replace all. `digest` receives a digest of all files, `json` one text with all
/// files (of fonts only the digests), which `templates_from` reads. If `below` is not empty, only
/// files whose names begin with one of its texts are read.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   std::string& digest, std::string* json = nullptr,
                                   const TemplateFiles& own = {},
                                   const std::vector<std::string>& below = {});

/// Returns the beginnings of file names (`below` of `read_templates`) for sentences in `language`:
/// its words, the English ones as a replacement, and the causes. Fonts and pages take most of the
/// time and are left out.
std::vector<std::string> words_in(const std::string& language);

/// Templates that were attached to a signed file.
struct CarriedTemplates {
  Templates templates;
  std::string sha256;                ///< digest, as `read_templates` returns it
  std::vector<std::string> strange;  ///< files, except fonts, that differ from the installed ones
  /// Name of a font that is not installed or has changed since the signing, because fonts are not
  /// attached; empty: none.
  std::string missing{};
};
/// Reads attached templates. An error if the text is not in the form that `read_templates` writes,
/// or if a template is not valid.
Expected<CarriedTemplates> templates_from(std::string_view json, const Templates& installed,
                                          std::string_view installed_json);

}  // namespace nonio::config
