// SPDX-License-Identifier: Apache-2.0
#include "nonio/workbench/page.h"

#include <variant>

#include "embedded.h"
#include "nonio/sdk/text.h"
#include "nonio/workbench/data.h"

namespace nonio::workbench {
namespace {

/// Words of the page that the shell itself has; the script knows the others.
constexpr std::string_view of_shell[] = {"shell.title", "shell.noscript"};

constexpr std::string_view of_campaign =
    "<link rel=\"stylesheet\" href=\"/uplot.css\">\n<link rel=\"stylesheet\" href=\"/app.css\">\n"
    "<script src=\"/uplot.js\" defer></script>\n<script src=\"/app.js\" defer></script>";
constexpr std::string_view of_site =
    "<link rel=\"stylesheet\" href=\"/morning.css\">\n"
    "<script src=\"/morning.js\" defer></script>";

void put(std::string& page, std::string_view place, std::string_view text) {
  for (std::size_t at = 0; (at = page.find(place, at)) != std::string::npos; at += text.size())
    page.replace(at, place.size(), text);
}

}  // namespace

std::map<std::string, std::string> words(const Templates& templates, const std::string& language) {
  std::map<std::string, std::string> out;
  for (const char* file : {"workbench", "workbench-site"}) {
    const auto table = templates.tables.find("words/" + language + "/" + file);
    if (table == templates.tables.end()) continue;
    for (const auto& [key, value] : table->second.values)
      if (const auto* text = std::get_if<std::string>(&value)) out[key] = *text;
  }
  return out;
}

Expected<std::string> shell_html(const Templates& templates, const std::string& language,
                                 Shell of) {
  const std::string name = "words/" + language + "/workbench";
  const auto table = templates.tables.find(name);
  if (table == templates.tables.end())
    return fail(Error{"the words of this language are missing", "templates/" + name + ".toml"});
  for (const std::string_view key : of_shell)
    if (!table->second.has(key))
      return fail(
          Error{"the key \"" + std::string(key) + "\" is missing", "templates/" + name + ".toml"});
  std::string as_json = "{";
  for (const auto& [key, text] : words(templates, language))
    as_json += (as_json.size() > 1 ? ",\n" : "") + json(key) + ":" + json(text);
  std::string page(embedded::shell);
  put(page, "{{language}}", escaped_markup(language, Markup::attribute));
  put(page, "{{title}}", escaped_markup(table->second.text("shell.title"), Markup::attribute));
  put(page, "{{noscript}}",
      escaped_markup(table->second.text("shell.noscript"), Markup::attribute));
  put(page, "{{files}}", of == Shell::site ? of_site : of_campaign);
  put(page, "{{words}}", as_json + "}");
  return page;
}

std::string_view app_js() { return embedded::app_js; }
std::string_view app_css() { return embedded::app_css; }
std::string_view morning_js() { return embedded::morning_js; }
std::string_view morning_css() { return embedded::morning_css; }
std::string_view uplot_js() { return embedded::uplot_js; }
std::string_view uplot_css() { return embedded::uplot_css; }

}  // namespace nonio::workbench
