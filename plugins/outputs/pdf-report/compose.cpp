// SPDX-License-Identifier: Apache-2.0

#include "nonio/reports/number.h"
#include "nonio/reports/text.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

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
