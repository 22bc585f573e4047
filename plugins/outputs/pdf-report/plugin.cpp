// SPDX-License-Identifier: Apache-2.0
// The report of a campaign as a PDF. Its texts and layout are in templates/.
#include "nonio/sdk/plugin.h"

#include <algorithm>

#include "nonio/reports/number.h"
#include "nonio/reports/text.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

namespace {

constexpr const char* default_template = "report";

bool applies(const Campaign&) { return true; }

bool wants_history(const Settings& options) { return options.flag("history"); }

void prepare(const Templates& templates) {
  if (const auto look = look_of(templates, default_template))
    (void)pages::fonts_of(templates, *look);
}

Expected<OutputResult> write(const OutputInput& in) {
  const std::string language = in.options.text("language", "en");
  NONIO_TRY(const auto look, look_of(in.templates, in.options.text("template", default_template)));
  NONIO_TRY(const auto fonts, pages::fonts_of(in.templates, look));
  if (const auto sound = pages::check_texts(in.campaign, *fonts); !sound)
    return fail(sound.error());
  if (wants_history(in.options) &&
      std::find(look.blocks.begin(), look.blocks.end(), "history") == look.blocks.end())
    return fail(
        Error{"options.pdf-report.history: the template has no block \"history\"; expected "
              "it in the list `blocks` of templates/" +
              in.options.text("template", default_template) + ".toml"});
  const Wording words(in.templates, language, {"results", "report"}),
      pictures(in.templates, language, {"pictures"}), site(in.templates, language, {"site"});
  const reports::Document document = compose({{in, look, words, *fonts}, pictures, site});
  for (const Wording* asked : {&words, &pictures, &site})
    if (const auto complete = asked->complete(); !complete) return fail(complete.error());
  NONIO_TRY(auto bytes, reports::pdf_bytes(document, *fonts));
  OutputResult result;
  result.artifacts.push_back({language == "en" ? "report.pdf" : "report-" + language + ".pdf",
                              std::move(bytes), in.options.flag("sign")});
  return result;
}

std::vector<Error> check_templates(const Templates& templates) {
  return pages::check_templates(templates, "report", look_of);
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.role = Output::Role::report;
  output.info = {
      "pdf-report",
      "1.0.0",
      "The campaign's report as a PDF with plots, in English, German or Italian.",
      {one_of({"de", "en", "it"}, {"language", std::string("en"), "", "Language of the report."}),
       {"template", std::string("report"), "", "Name of the template: templates/<name>.toml."},
       {"sign", false, "", "Have it signed with the key of [signing] in site.toml."},
       {"history", false, "",
        "A page with the machine's history up to this campaign: trends, changes, next due date."}}};
  output.applies = applies;
  output.check_templates = check_templates;
  output.write = write;
  output.prepare = prepare;
  output.wants_history = wants_history;
  registry.add(std::move(output));
}

using namespace reports;

namespace {

void add_measurements(const Source& source, Blocks& blocks) {
  for (const Measured& m : measured(source.in)) {
    const std::string field = "measurement " + m.measurement.id;
    blocks.push_back({Heading{heading_of(source, m), 1}, field});
    blocks.push_back({Paragraph{test_of(source, m), Paragraph::Look::small, true}, field});
    for (const std::string& part : source.look.measurement) {
      if (part == "results") add_results(source, m, blocks);
      if (part == "plots") add_plots(source, m, blocks);
      if (part == "findings") add_findings(source, m, blocks);
      if (part == "targets") add_targets(source, m, blocks);
      if (part == "budget") add_budget(source, m, blocks);
    }
  }
}

}  // namespace

Expected<pages::Look> look_of(const Templates& templates, const std::string& name) {
  return pages::read_look(templates, name,
                          {"title", "identity", "status", "summary", "measurements", "notes",
                           "history", "laboratory", "models", "tables", "residuals"},
                          {"results", "plots", "findings", "targets", "budget"});
}

Document compose(const Source& source) {
  const Campaign& campaign = source.in.campaign;
  const Wording& words = source.words;
  const std::string machine = campaign.machine.model +
                              (campaign.machine.serial.empty() ? "" : " ") +
                              campaign.machine.serial;
  Document document;
  document.style = source.look.style;
  document.language = source.language();
  document.date = campaign.date;
  document.title = words.get("title") + " " + campaign.id;
  document.author = campaign.laboratory.name;
  document.subject = machine;
  document.head = without_gaps(words.get("head", {{"title", words.get("title")},
                                                  {"id", campaign.id},
                                                  {"machine", machine},
                                                  {"laboratory", campaign.laboratory.name},
                                                  {"date", campaign.date}}));
  document.foot = without_gaps(words.get(
      "foot",
      {{"id", campaign.id}, {"date", campaign.date}, {"laboratory", campaign.laboratory.name}}));
  document.page_of = words.get("page_of");
  for (const std::string& block : source.look.blocks) {
    if (block == "title") add_title(source, document.blocks);
    if (block == "identity") add_identity(source, document.blocks);
    if (block == "status") add_status(source, document.blocks);
    if (block == "summary") add_summary(source, document.blocks);
    if (block == "measurements") {
      add_measurements(source, document.blocks);
      add_plans(source, document.blocks);
    }
    if (block == "history") add_history(source, document.blocks);
    if (block == "laboratory") add_laboratory(source, document.blocks);
    if (block == "models") add_models(source, document.blocks);
    if (block == "tables") add_tables(source, document.blocks);
    if (block == "notes") add_notes(source, document.blocks);
    if (block == "residuals") add_residuals(source, document.blocks);
  }
  document.blocks.push_back({Paragraph{words.get("end"), Paragraph::Look::small}, "end"});
  return document;
}

}  // namespace nonio::pdf_report
