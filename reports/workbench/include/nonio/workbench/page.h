// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

/// The page of `nonio live`, as bytes.
namespace nonio::workbench {

/// The shell without data: language, words and the addresses of the rest. The words are those of
/// templates/words/<language>/workbench.toml; an error says which are missing.
Expected<std::string> shell_html(const Templates& templates, const std::string& language);

/// The drawing code and the page's own script, and its style.
std::string_view app_js();
std::string_view app_css();

/// third_party/uplot, byte for byte.
std::string_view uplot_js();
std::string_view uplot_css();

/// The drawing code alone (page/draw.js, page/draw.css), which the page from disk embeds.
std::string_view draw_js();
std::string_view draw_css();

}  // namespace nonio::workbench
