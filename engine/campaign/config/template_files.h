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

struct TemplateFiles {
  std::filesystem::path folder{};
  std::map<std::string, std::string> files{};
};

/// Returns every file by its path relative to the folder. Links to folders are followed.
Expected<std::map<std::string, std::filesystem::path>> template_paths(
    const std::filesystem::path& folder);

/// Later folders replace files of earlier ones, and `own` replaces all. `digest` receives a digest
/// of all files, `json` the text that `templates_from` reads. If `below` is not empty, only files
/// whose names begin with one of its texts are read. If `languages` is not empty, words of other
/// languages in the first folder only count for `digest`.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   std::string& digest, std::string* json = nullptr,
                                   const TemplateFiles& own = {},
                                   const std::vector<std::string>& below = {},
                                   const std::vector<std::string>& languages = {});

/// Returns `below` of `read_templates` for sentences in `language`, without fonts and pages.
std::vector<std::string> words_in(const std::string& language);

/// Templates that were attached to a signed file.
struct CarriedTemplates {
  Templates templates;
  std::string sha256;
  std::vector<std::string> strange;  ///< files, except fonts, that differ from the installed ones
  /// Name of a font that is not installed or has changed since the signing; otherwise empty.
  std::string missing{};
};
/// Returns an error if the text does not come from `read_templates` or a template is not valid.
Expected<CarriedTemplates> templates_from(std::string_view json, const Templates& installed,
                                          std::string_view installed_json);

}  // namespace nonio::config
