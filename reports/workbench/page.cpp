// SPDX-License-Identifier: Apache-2.0
#include "nonio/workbench/page.h"

#include "embedded.h"
#include "nonio/reports/drawing.h"
#include "nonio/reports/page.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/workbench/data.h"

namespace nonio::workbench {

using namespace reports;

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
  const Wording of_page(templates, language, {"workbench"});
  JsonWriter json(JsonWriter::Layout::in_script);
  json.begin_object();
  for (const auto& [key, text] : words(templates, language)) json.member(key, text);
  const Wording of_charts(templates, language, {"pictures"});
  for (const char* key : chart_words) json.member(key, of_charts.get(key));
  json.end_object();
  View view;
  view.set("language", language).flag("campaign", of == Shell::campaign);
  view.set("all_words", Html{json.take()});
  auto page = page_text("live", view, of_page);
  if (auto complete = of_page.complete(); !complete) return fail(complete.error());
  return page;
}

std::string_view app_js() { return embedded::app_js; }
std::string_view app_css() { return embedded::app_css; }
std::string_view site_js() { return embedded::site_js; }
std::string_view site_css() { return embedded::site_css; }

}  // namespace nonio::workbench
