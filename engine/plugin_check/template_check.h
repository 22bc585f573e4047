// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::plugin_check {

struct TemplateCheck {
  std::vector<Error> errors;         ///< each names the file and the key
  std::vector<std::string> outputs;  ///< those that looked at their templates
};

/// What every output reports about its templates: layouts, words of all languages, letters that the
/// fonts lack. Later folders win. An error if the folders or plugins cannot be read.
Expected<TemplateCheck> check_templates(const std::vector<std::filesystem::path>& template_folders,
                                        const std::vector<std::filesystem::path>& plugin_folders);

}  // namespace nonio::plugin_check
