// SPDX-License-Identifier: Apache-2.0
//
// The certificate (or report) of calibration for the customer: a PDF and a Digital Calibration
// Certificate, both signed by the host, under a number that the host draws.
#include <algorithm>

#include "certificate.h"
#include "nonio/reports/picture.h"
#include "two_languages.h"

namespace nonio::certificate {

using namespace reports;

namespace {

constexpr const char* version = "1.0.0";
constexpr const char* words_file = "certificate";

bool applies(const Campaign&) { return true; }

Wording words_of(const Templates& templates, const std::string& language) {
  return {templates, language, {"results", words_file}};
}

void prepare(const Templates& templates) {
  if (const auto look = look_of(templates, words_file)) (void)pages::fonts_of(templates, *look);
}

/// Marks what the customer stated; the keys that are printed nowhere stay.
void mark(Blocks& blocks, std::vector<std::string>& keys) {
  std::vector<std::string> found;
  const auto visit = [&](const auto& self, Blocks& all) -> void {
    for (Block& block : all) {
      if (auto* columns = std::get_if<Columns>(&block.what))
        for (Blocks& part : columns->parts) self(self, part);
      if (auto* grid = std::get_if<Grid>(&block.what))
        for (Grid::Row& row : grid->rows)
          if (!row.value.empty() && std::find(keys.begin(), keys.end(), row.field) != keys.end()) {
            row.value += " *";
            found.push_back(row.field);
          }
    }
  };
  visit(visit, blocks);
  std::erase_if(keys, [&](const std::string& key) {
    return std::find(found.begin(), found.end(), key) != found.end();
  });
}

Expected<void> mark_customer_data(const OutputInput& in, Document& document) {
  std::vector<std::string> keys = in.campaign.certificate.customer_data;
  mark(document.blocks, keys);
  mark(document.first_foot, keys);
  if (keys.empty()) return {};
  Error error{
      "certificate.customer_data: expected keys whose values are printed, such as "
      "\"machine.serial\", found \"" +
      keys.front() + "\""};
  error.key = "certificate.customer_data";
  return fail(error);
}

Expected<Document> document_of(const OutputInput& in, const pages::Look& look, const Fonts& fonts) {
  std::vector<Document> documents;
  for (const std::string& language : in.campaign.certificate.languages) {
    const Wording words = words_of(in.templates, language);
    documents.push_back(compose({in, look, words, fonts, true}));
    if (const auto complete = words.complete(); !complete) return fail(complete.error());
  }
  Document document = std::move(documents.front());
  if (documents.size() == 2) document = pages::side_by_side(std::move(document), documents.back());
  if (auto marked = mark_customer_data(in, document); !marked) return fail(marked.error());
  return document;
}

std::string dcc_of(const OutputInput& in, const pages::Look& look, const Fonts& fonts) {
  std::vector<Wording> words;
  for (const std::string& language : in.campaign.certificate.languages)
    words.push_back(words_of(in.templates, language));
  std::vector<Source> sources;
  for (const Wording& w : words) sources.push_back({in, look, w, fonts, true});
  return dcc::write(in, about_of(sources, version));
}

Expected<OutputResult> write(const OutputInput& in) {
  if (in.issue == nullptr) return fail("a certificate needs a number, and none was drawn");
  const auto look = look_of(in.templates, in.campaign.certificate.form);
  if (!look) return fail(look.error());
  const auto fonts = pages::fonts_of(in.templates, *look);
  if (!fonts) return fail(fonts.error());
  if (const auto sound = pages::check_texts(in.campaign, **fonts); !sound)
    return fail(sound.error());
  const auto document = document_of(in, *look, **fonts);
  if (!document) return fail(document.error());
  auto bytes = pdf_bytes(*document, **fonts);
  if (!bytes) return fail(bytes.error());
  OutputResult result;
  result.artifacts.push_back({"certificate.pdf", std::move(*bytes), true});
  if (!in.issue->is_draft())
    result.artifacts.push_back({"certificate.xml", dcc_of(in, *look, **fonts), true});
  return result;
}

Expected<pages::Look> with_pictures(const Templates& templates, const std::string& name) {
  auto look = look_of(templates, name);
  if (!look) return look;
  for (const std::string& picture : {look->logo, look->mark})
    if (!picture.empty())
      if (auto sound = shared_picture(templates.files.at(picture), "templates/" + picture); !sound)
        return fail(sound.error());
  return look;
}

std::vector<Error> check_templates(const Templates& templates) {
  return pages::check_templates(templates, words_file, with_pictures);
}

}  // namespace

/// Words of every language that claim an accreditation are listed in title.claims, divided by commas.
std::string accredited_claim(const OutputInput& in) {
  const auto lower = [](std::string text) {
    for (char& c : text)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
  };
  for (const auto& [language, title] : in.campaign.certificate.title)
    for (const auto& [name, table] : in.templates.tables) {
      if (!name.starts_with("words/") || !name.ends_with(std::string("/") + words_file)) continue;
      const std::string claims = lower(table.text("title.claims"));
      for (std::size_t at = 0; at < claims.size();) {
        const std::size_t end = std::min(claims.find(", ", at), claims.size());
        const std::string claim = claims.substr(at, end - at);
        if (!claim.empty() && lower(title).find(claim) != std::string::npos)
          return "the title \"" + title + "\" is that of an accredited laboratory";
        at = end + 2;
      }
    }
  const auto look = look_of(in.templates, in.campaign.certificate.form);
  return look && !look->mark.empty() ? "the template has the mark " + look->mark : "";
}

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"certificate",
                 version,
                 "The signed calibration report or certificate for the customer, with its DCC.",
                 {},
                 true};
  output.applies = applies;
  output.write = write;
  output.prepare = prepare;
  output.certificate = {.missing_requirements = lacks};
  output.check_templates = check_templates;
  registry.add(std::move(output));
}

}  // namespace nonio::certificate
