// SPDX-License-Identifier: Apache-2.0
#include "certificate_reader.h"

#include <algorithm>

#include "nonio/host/register.h"

namespace nonio::host {

namespace {

bool is_language(const std::string& text) {
  return text.size() == 2 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

bool is_word(const std::string& text) {
  return text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") == std::string::npos;
}

/// One text for all languages stands under "".
std::map<std::string, std::string> read_title(TableReader& reader) {
  std::map<std::string, std::string> title;
  const toml::node* node = reader.raw().get("title");
  if (node == nullptr || node->is_string()) {
    if (const std::string text = reader.text("title"); !text.empty()) title[""] = text;
    return title;
  }
  const toml::table* table = reader.table("title");
  if (table == nullptr) return title;
  for (const auto& [key, value] : *table) {
    const std::string language(key.str());
    const auto text = value.value<std::string>();
    if (!is_language(language) || !text || !value.is_string())
      reader.error("title", "wanted a text, or texts by language, { it = \"...\", en = \"...\" }");
    else
      title[language] = *text;
  }
  return title;
}

}  // namespace

CertificateTexts read_certificate(TableReader& reader) {
  CertificateTexts c;
  c.languages = reader.texts("languages").value_or(std::vector<std::string>{});
  const bool two = c.languages.size() == 2 && c.languages[0] == c.languages[1];
  if (c.languages.size() > 2 || two ||
      !std::all_of(c.languages.begin(), c.languages.end(), is_language))
    reader.error("languages", "wanted one or two languages, [\"it\", \"en\"]");
  c.form = reader.text("template");
  if (!is_word(c.form))
    reader.error("template", "wanted the name of a file in templates/, without .toml");
  c.location = reader.choice(
      "location", {"laboratory", "customer", "laboratoryBranch", "customerBranch", "other"});
  c.procedure = reader.text("procedure");
  c.title = read_title(reader);
  reader.choice("decision_rule", {"iso14253-1"});
  return c;
}

void read_certificate_of_campaign(TableReader& reader, CertificateTexts& into) {
  into.deviations = reader.text("deviations");
  into.conditions = reader.text("conditions");
  into.opinions = reader.text("opinions");
  into.amendment = reader.text("amendment");
  into.customer_data = reader.texts("customer_data").value_or(std::vector<std::string>{});
}

Numbering read_numbering(TableReader& reader) {
  Numbering n;
  if (const std::string pattern = reader.text("numbering"); !pattern.empty()) n.pattern = pattern;
  if (const std::string file = reader.text("register"); !file.empty()) n.register_file = file;
  if (const auto sound = number_text(n.pattern, "2026", 1); !sound)
    reader.error("numbering", sound.error().message);
  return n;
}

CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign) {
  CertificateTexts out = campaign;
  if (out.languages.empty()) out.languages = site.languages;
  if (out.languages.empty()) out.languages = {"en"};
  if (out.title.empty()) out.title = site.title;
  for (const auto& [mine, others, otherwise] : {std::tuple{&out.form, &site.form, "certificate"},
                                                {&out.location, &site.location, "customer"},
                                                {&out.procedure, &site.procedure, ""}}) {
    if (mine->empty()) *mine = *others;
    if (mine->empty()) *mine = otherwise;
  }
  return out;
}

}  // namespace nonio::host
