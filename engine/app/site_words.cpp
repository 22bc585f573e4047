// SPDX-License-Identifier: Apache-2.0
#include "site_words.h"

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/evaluation/record.h"
#include "laboratory/assessment/last_run.h"

namespace nonio::app {
namespace fs = std::filesystem;

std::string language_at(const fs::path& path) {
  std::error_code error;
  for (fs::path folder = fs::weakly_canonical(path, error); !error && !folder.empty();
       folder = folder.parent_path()) {
    if (fs::exists(folder / config::site_name, error)) {
      std::string digest;
      const auto site = config::read_site(folder, digest);
      return site ? site->language : "en";
    }
    if (const auto record = evaluation::read_record(folder); record && !record->language.empty())
      return record->language;
    if (const auto run = assessment::last_run_in(folder)) return run->language;
    if (folder == folder.parent_path()) break;
  }
  return "en";
}

SiteWords::SiteWords(const Common& common, const std::string& language, const std::string& more) {
  std::vector<std::string> files;
  for (const std::string& folder : {std::string("words/en/"), "words/" + language + "/"})
    for (const std::string& file : {std::string("terminal"), std::string("site"), more})
      files.push_back(folder + file);
  if (auto read = config::read_templates(common.template_folders(), {}, files))
    templates_ = std::move(*read);
  words_.emplace(templates_,
                 templates_.tables.contains("words/" + language + "/terminal") ? language : "en");
}

void SiteWords::take(const config::TerminalWords& words) {
  for (const std::string& language : {std::string("en"), words.language()})
    if (const auto table = words.templates().tables.find("words/" + language + "/terminal");
        table != words.templates().tables.end())
      templates_.tables[table->first] = table->second;
  words_.emplace(templates_, words.language());
}

}  // namespace nonio::app
