// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::plugin_check {

struct TemplateCheck {
  std::vector<Error> errors;
  std::vector<std::string> outputs;
};

/// Returns what every output reports about its templates: layouts, words of all languages, letters
/// that the fonts lack. Later folders have precedence. An error if folders or plugins cannot be
/// read.
Expected<TemplateCheck> check_templates(const std::vector<std::filesystem::path>& template_folders,
                                        const std::vector<std::filesystem::path>& plugin_folders);

}  // namespace nonio::plugin_check
