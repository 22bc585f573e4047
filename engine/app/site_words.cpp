// SPDX-License-Identifier: Apache-2.0
#include "site_words.h"

#include "campaign/config/template_files.h"

namespace nonio::app {

SiteWords::SiteWords(const Common& common, const std::string& language) {
  std::string digest;
  if (auto read = config::read_templates(common.template_folders(), digest, nullptr, {},
                                         {"words/en/terminal", "words/" + language + "/terminal"}))
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
