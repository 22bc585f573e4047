// SPDX-License-Identifier: Apache-2.0
// The certificate (or report) of calibration for the customer: a PDF and a Digital Calibration
// Certificate. The host assigns the number and signs both.
#include <algorithm>

#include "certificate.h"
#include "nonio/reports/document.h"
#include "nonio/reports/picture.h"

namespace nonio::certificate {
using namespace reports;

namespace {

using Blocks = std::vector<Block>;

bool same(const std::string& a, const std::string& b) {
  const auto plain = [](char c) { return c == ',' ? '.' : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return plain(x) == plain(y); });
}

bool join_in_brackets(std::string& a, const std::string& b) {
  const std::size_t open = a.find(" (");
  if (open == std::string::npos || open == 0 || b.find(" (") != open || !a.ends_with(')') ||
      !b.ends_with(')') || !same(a.substr(0, open), b.substr(0, open)))
    return false;
  a.pop_back();
  a += " / " + b.substr(open + 2);
  return true;
}

void join(std::string& a, const std::string& b, const char* between = " / ") {
  if (!same(a, b) && !join_in_brackets(a, b)) a += between + b;
}

Blocks joined(Blocks first, const Blocks& second);

void merge(Table& a, const Table& b) {
  join(a.title, b.title);
  for (std::size_t i = 0; i < a.columns.size(); ++i) join(a.columns[i].title, b.columns[i].title);
  for (std::size_t r = 0; r < a.rows.size(); ++r)
    for (std::size_t i = 0; i < a.rows[r].size(); ++i)
      if (!a.columns[i].number) join(a.rows[r][i].text, b.rows[r][i].text);
}

void merge(Grid& a, const Grid& b) {
  join(a.title, b.title);
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    join(a.rows[i].label, b.rows[i].label);
    join(a.rows[i].value, b.rows[i].value);
  }
}

/// Axis titles are joined by " · ", because "/" precedes the unit. The y title remains in one
/// language for lack of space.
void merge(Plot& a, const Plot& b) {
  join(a.title, b.title);
  join(a.x_title, b.x_title, " · ");
  join(a.empty_text, b.empty_text);
  for (std::size_t i = 0; i < std::min(a.curves.size(), b.curves.size()); ++i)
    join(a.curves[i].legend, b.curves[i].legend);
}

/// The row labels must not depend on the language.
void merge(BarChart& a, const BarChart& b) {
  join(a.title, b.title);
  join(a.x_title, b.x_title, " · ");
}

Block merged(Block a, const Block& b) {
  if (auto* heading = std::get_if<Heading>(&a.what)) {
    join(heading->text, std::get<Heading>(b.what).text);
  } else if (auto* paragraph = std::get_if<Paragraph>(&a.what)) {
    constexpr std::size_t line = 60;
    const std::string& other = std::get<Paragraph>(b.what).text;
    if (same(paragraph->text, other)) return a;
    if (paragraph->text.size() > line || other.size() > line) return {Columns{{{a}, {b}}}, a.field};
    join(paragraph->text, other);
  } else if (auto* grid = std::get_if<Grid>(&a.what)) {
    merge(*grid, std::get<Grid>(b.what));
  } else if (auto* table = std::get_if<Table>(&a.what)) {
    merge(*table, std::get<Table>(b.what));
  } else if (auto* plot = std::get_if<Plot>(&a.what)) {
    merge(*plot, std::get<Plot>(b.what));
  } else if (auto* chart = std::get_if<BarChart>(&a.what)) {
    merge(*chart, std::get<BarChart>(b.what));
  } else if (auto* note = std::get_if<Note>(&a.what)) {
    const Note& other = std::get<Note>(b.what);
    join(note->title, other.title);
    join(note->says, other.says);
    join(note->advice, other.advice);
  } else if (auto* code = std::get_if<Code>(&a.what)) {
    join(code->caption, std::get<Code>(b.what).caption);
  } else if (auto* box = std::get_if<SignatureBox>(&a.what)) {
    const SignatureBox& other = std::get<SignatureBox>(b.what);
    join(box->title, other.title);
    for (std::size_t i = 0; i < box->lines.size(); ++i) join(box->lines[i], other.lines[i]);
  } else if (auto* columns = std::get_if<Columns>(&a.what)) {
    const Columns& other = std::get<Columns>(b.what);
    for (std::size_t i = 0; i < columns->parts.size(); ++i)
      columns->parts[i] = joined(std::move(columns->parts[i]), other.parts[i]);
  }
  return a;
}

Blocks joined(Blocks first, const Blocks& second) {
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = merged(std::move(first[i]), second[i]);
  return first;
}

/// Merges documents in two languages: labels are joined, sentences are side by side, and numbers
/// are printed once with the decimal separator of the first.
Document side_by_side(Document first, const Document& second) {
  join(first.title, second.title);
  join(first.page_of, second.page_of);
  join(first.mark, second.mark);
  first.blocks = joined(std::move(first.blocks), second.blocks);
  first.first_foot = joined(std::move(first.first_foot), second.first_foot);
  return first;
}

constexpr const char* version = "1.0.0";
constexpr const char* words_file = "certificate";

bool applies(const Campaign&) { return true; }

Wording words_of(const Templates& templates, const std::string& language) {
  return {templates, language, {"results", words_file}};
}

void prepare(const Templates& templates) {
  if (const auto look = look_of(templates, words_file)) (void)pages::fonts_of(templates, *look);
}

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
  if (documents.size() == 2) document = side_by_side(std::move(document), documents.back());
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
  NONIO_TRY(const auto look, look_of(in.templates, in.campaign.certificate.form));
  NONIO_TRY(const auto fonts, pages::fonts_of(in.templates, look));
  if (const auto sound = pages::check_texts(in.campaign, *fonts); !sound)
    return fail(sound.error());
  NONIO_TRY(const auto document, document_of(in, look, *fonts));
  NONIO_TRY(auto bytes, pdf_bytes(document, *fonts));
  OutputResult result;
  result.artifacts.push_back({"certificate.pdf", std::move(bytes), true});
  if (!in.issue->is_draft())
    result.artifacts.push_back({"certificate.xml", dcc_of(in, look, *fonts), true});
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

/// A title is a claim if it contains one of the words in title.claims of any language, a list
/// separated by commas.
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

namespace {

void add_measurements(const Source& source, Blocks& blocks) {
  for (const pages::Measured& m : pages::measured(source.in)) {
    if (!is_printed(m)) continue;
    const std::string field = "measurement " + m.measurement.id;
    std::string heading = pages::heading_of(source, m);
    if (!m.measurement.adjustment.empty())
      heading += " – " + source.words.get("adjustment." + m.measurement.adjustment);
    blocks.push_back({Heading{heading, 1}, field});
    blocks.push_back({Paragraph{pages::test_of(source, m), Paragraph::Look::small, true}, field});
    blocks.push_back({Paragraph{test_parameters(source, m), Paragraph::Look::small, true}, field});
    for (const std::string& part : source.look.measurement) {
      if (part == "results") pages::add_results(source, m, blocks);
      if (part == "plots") pages::add_plots(source, m, blocks);
      if (part == "targets") pages::add_targets(source, m, blocks);
      if (part == "budget") pages::add_budget(source, m, blocks);
    }
  }
}

struct Part {
  const char* name;
  void (*add)(const Source&, Blocks&);
};
constexpr Part parts[] = {{"title", add_title},           {"amendment", add_amendment},
                          {"parties", add_parties},       {"item", add_item},
                          {"method", add_method},         {"conditions", add_conditions},
                          {"results", add_measurements},  {"conformity", add_conformity},
                          {"overview", add_overview},     {"opinions", add_opinions},
                          {"statements", add_statements}, {"authority", add_authority}};

/// Mandatory parts, which a template can move but not omit.
constexpr const char* wanted[] = {"title",    "amendment",  "parties",  "item",
                                  "method",   "conditions", "results",  "conformity",
                                  "opinions", "statements", "authority"};

}  // namespace

Expected<pages::Look> look_of(const Templates& templates, const std::string& name) {
  std::vector<std::string> names;
  for (const Part& part : parts) names.emplace_back(part.name);
  auto look = pages::read_look(templates, name, names, {"results", "plots", "targets", "budget"});
  if (!look) return look;
  const std::string file = "templates/" + name + ".toml";
  for (const char* part : wanted)
    if (std::find(look->blocks.begin(), look->blocks.end(), part) == look->blocks.end())
      return fail(Error{"the key \"blocks\" lacks \"" + std::string(part) +
                            "\", which every certificate must contain; it may be elsewhere",
                        file});
  for (const std::string& part : {look->logo, look->mark, look->profile})
    if (!part.empty() && !templates.files.contains(part))
      return fail(Error{"the file \"" + part + "\" is not there", file});
  return look;
}

std::string title_of(const Source& source) {
  const auto& titles = source.in.campaign.certificate.title;
  for (const std::string& language : {source.language(), std::string()})
    if (const auto it = titles.find(language); it != titles.end()) return it->second;
  return source.words.get("title.default");
}

std::string number_of(const Source& source) {
  const Issue& issue = *source.in.issue;
  return issue.is_draft() ? source.words.get("draft.number") : issue.number;
}

Document compose(const Source& source) {
  const Campaign& c = source.in.campaign;
  const Issue& issue = *source.in.issue;
  const std::string title = title_of(source), number = number_of(source);
  Document document;
  document.style = source.look.style;
  document.language = source.language();
  document.date = issue.date;
  document.title = title + " " + number;
  document.author = c.laboratory.name;
  document.subject = c.machine.model + " " + c.machine.serial;
  document.head = pages::without_gaps(title + " " + number + " · " + c.laboratory.name);
  document.foot = document.title;
  if (const auto profile = source.in.templates.files.find(source.look.profile);
      profile != source.in.templates.files.end())
    document.profile = std::string_view(profile->second);
  document.page_of = source.words.get("title.page_of");
  if (issue.is_draft()) document.mark = source.words.get("draft.mark");
  for (const std::string& name : source.look.blocks)
    for (const Part& part : parts)
      if (name == part.name) part.add(source, document.blocks);
  add_signature(source, document.first_foot);
  document.blocks.push_back(
      {Paragraph{source.words.get("title.end", {{"number", number}}), Paragraph::Look::small},
       "end"});
  return document;
}

}  // namespace nonio::certificate
