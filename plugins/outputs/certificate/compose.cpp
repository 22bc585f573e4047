// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "certificate.h"

namespace nonio::certificate {

using namespace reports;

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
    document.profile = profile->second;
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
