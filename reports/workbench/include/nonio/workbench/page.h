// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

/// The page of `nonio serve`, as bytes.
namespace nonio::workbench {

/// Of which page.
enum class Shell { campaign, site };

/// The shell without data: language, words and the addresses of the rest. The words are those of
/// templates/words/<language>/workbench.toml and workbench-site.toml; an error states which of the
/// shell are missing.
Expected<std::string> shell_html(const Templates& templates, const std::string& language, Shell of);
/// The same words, "refused.token" and so on.
std::map<std::string, std::string> words(const Templates& templates, const std::string& language);

/// The drawing code and the script of a campaign's page, and its style.
std::string_view app_js();
std::string_view app_css();
/// Script and style of a site's page.
std::string_view site_js();
std::string_view site_css();

}  // namespace nonio::workbench
