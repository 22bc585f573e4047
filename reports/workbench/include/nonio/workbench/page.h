// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"
#include "nonio/sdk/templates.h"

namespace nonio::workbench {

enum class Shell { campaign, site };

/// The HTML without data: language, texts and URLs of the other resources. Texts are in
/// templates/words/<language>/workbench.toml and workbench-site.toml. Error: missing texts.
Expected<std::string> shell_html(const Templates& templates, const std::string& language, Shell of);
/// The texts of the shell, with keys such as "refused.token".
std::map<std::string, std::string> words(const Templates& templates, const std::string& language);

/// Script (with drawing code) and style of a campaign page.
std::string_view app_js();
std::string_view app_css();
/// Script and style of a site page.
std::string_view site_js();
std::string_view site_css();

}  // namespace nonio::workbench
