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

/// Texts that belong to the templates.
struct TemplateTexts {
  std::string sha256;  ///< of all files
  std::string json{};  ///< what `templates_from` reads
};

/// Later folders replace files of earlier ones, and `own` replaces all. The words of the first
/// folder, which belongs to the program, are read when they are needed. If `below` is not empty,
/// only files whose names begin with one of its texts are read. `texts`, if not null, is filled;
/// `texts->json` only if `with_json`.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   const TemplateFiles& own = {},
                                   const std::vector<std::string>& below = {},
                                   TemplateTexts* texts = nullptr, bool with_json = false);

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
