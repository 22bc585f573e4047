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

/// Templates that were read already: names below the folder, and bytes.
struct TemplateFiles {
  std::filesystem::path folder{};
  std::map<std::string, std::string> files{};
};

/// Every file below a folder, links to folders followed, as paths relative to it.
Expected<std::map<std::string, std::filesystem::path>> template_paths(
    const std::filesystem::path& folder);

/// All template folders laid over each other, the later ones winning, and one digest of them.
/// `json`, if wanted: all of them in one text, from which `templates_from` has them again.
/// `own` wins over all folders. `below`, if any: only files whose names begin with one of these.
Expected<Templates> read_templates(const std::vector<std::filesystem::path>& folders,
                                   std::string& digest, std::string* json = nullptr,
                                   const TemplateFiles& own = {},
                                   const std::vector<std::string>& below = {});

/// What sentences in `language` need: its words, the English ones for those that it lacks, and the
/// causes. No fonts and pages, which take most of the time.
std::vector<std::string> words_in(const std::string& language);

/// Templates that travelled in a signed file.
struct CarriedTemplates {
  Templates templates;
  std::string sha256;                ///< as `read_templates` gives it
  std::vector<std::string> strange;  ///< names of those that differ from the installed ones
  std::string missing{};  ///< a font (they do not travel) that is not installed as it was then
};
/// An error if the text is not as `read_templates` writes it.
Expected<CarriedTemplates> templates_from(std::string_view json, const Templates& installed,
                                          std::string_view installed_json);

}  // namespace nonio::config
