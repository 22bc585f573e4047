// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

#include <array>

#include "embedded.h"
#include "nonio/reports/drawing.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::reports {

namespace {

/// If fonts are missing in the templates, text widths in charts are estimated.
Expected<std::shared_ptr<const Fonts>> fonts_of(const Templates& templates) {
  std::array<FontFile, 2> files{
      {{"", "fonts/LiberationSans-Regular.ttf"}, {"", "fonts/LiberationSans-Bold.ttf"}}};
  for (auto& [bytes, name] : files) {
    const auto file = templates.files.find(name);
    if (file == templates.files.end()) return std::make_shared<const Fonts>();
    bytes = file->second;
  }
  return shared_fonts(files[0], files[1]);
}

std::string charts_script(const Templates& templates, const std::string& language) {
  const Wording words(templates, language, {"pictures"});
  JsonWriter json(JsonWriter::Layout::in_script);
  json.begin_object();
  for (const char* key : chart_words) json.member(key, words.get(key));
  json.end_object();
  return "const nonioWords = " + json.take() + ";\n" + std::string(site::charts_script);
}

}  // namespace

Expected<std::vector<Artifact>> site_lists(const SiteHistory& history, const Templates& templates,
                                           const std::string& language) {
  const Wording words(templates, language, {"site"});
  NONIO_TRY(const auto fonts, fonts_of(templates));
  const site::Page root{history, templates, words, "", fonts};
  using Written = Expected<std::string> (*)(const site::Page&);
  constexpr std::pair<const char*, Written> pages[] = {{"index.html", site::index_page},
                                                       {"due.html", site::due_page},
                                                       {"instruments.html", site::instruments_page},
                                                       {"compare.html", site::compare_page}};
  std::vector<Artifact> out{{"due.ics", site::due_calendar(root)},
                            {"charts.js", charts_script(templates, language)}};
  for (const auto& [name, write] : pages) {
    NONIO_TRY(auto bytes, write(root));
    out.push_back({name, std::move(bytes)});
  }
  if (auto complete = words.complete(); !complete) return fail(complete.error());
  return out;
}

Expected<Artifact> machine_page_of(const SiteHistory& history, const MachineHistory& machine,
                                   const Templates& templates, const std::string& language) {
  const Wording words(templates, language, {"site"});
  NONIO_TRY(const auto fonts, fonts_of(templates));
  const site::Page below{history, templates, words, "../", fonts};
  NONIO_TRY(auto bytes, site::machine_page(below, machine));
  if (auto complete = words.complete(); !complete) return fail(complete.error());
  return Artifact{std::string(machines_folder) + "/" + machine.file, std::move(bytes)};
}

Expected<std::vector<Artifact>> site_pages(const SiteHistory& history, const Templates& templates,
                                           const std::string& language) {
  auto out = site_lists(history, templates, language);
  if (!out) return out;
  for (const MachineHistory& m : history.machines) {
    NONIO_TRY(auto page, machine_page_of(history, m, templates, language));
    out->push_back(std::move(page));
  }
  return out;
}

}  // namespace nonio::reports
