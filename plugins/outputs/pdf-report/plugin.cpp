// SPDX-License-Identifier: Apache-2.0
//
// The report of a campaign as a PDF, for people. What it says and shows is in templates/.
#include "nonio/sdk/plugin.h"

#include "nonio/reports/text.h"
#include "report.h"

namespace nonio::pdf_report {
namespace {

constexpr const char* default_template = "report";

bool applies(const Campaign&) { return true; }

void prepare(const Templates& templates) {
  if (const auto look = look_of(templates, default_template))
    (void)pages::fonts_of(templates, *look);
}

/// What the manifest brings, before it is lost in sentences: by key, so that the host can say
/// where.
Expected<void> check_texts(const Campaign& c, const reports::Fonts& fonts) {
  const Machine& m = c.machine;
  const Instrument& i = c.instrument;
  const Laboratory& l = c.laboratory;
  std::vector<std::pair<std::string, std::string>> texts = {
      {"campaign.customer", c.customer},
      {"campaign.site", c.site},
      {"campaign.operator", c.operator_name},
      {"machine.maker", m.maker},
      {"machine.model", m.model},
      {"machine.serial", m.serial},
      {"instrument.maker", i.maker},
      {"instrument.model", i.model},
      {"instrument.serial", i.serial},
      {"instrument.certificate", i.certificate},
      {"laboratory.name", l.name},
      {"laboratory.address", l.address},
      {"laboratory.country", l.country},
      {"laboratory.accreditation", l.accreditation},
      {"laboratory.authoriser", l.authoriser}};
  for (const Axis& a : m.axes) {
    texts.emplace_back("machine.axes." + a.name, a.name);
    for (const auto& [name, limit] : a.tolerance)
      texts.emplace_back("machine.axes." + a.name, name);
  }
  for (const Measurement& one : c.measurements) {
    const std::string key = "measurement." + one.id + ".";
    texts.emplace_back(key + "id", one.id);
    texts.emplace_back(key + "axis", one.axis);
    texts.emplace_back(key + "lateral", one.lateral);
  }
  for (const auto& [key, text] : texts)
    if (auto printable = reports::check_text(text, fonts, key); !printable) {
      printable.error().key = key;
      return printable;
    }
  return {};
}

Expected<OutputResult> write(const OutputInput& in) {
  const std::string language = in.options.text("language", "en");
  const auto look = look_of(in.templates, in.options.text("template", default_template));
  if (!look) return fail(look.error());
  const auto fonts = pages::fonts_of(in.templates, *look);
  if (!fonts) return fail(fonts.error());
  if (const auto sound = check_texts(in.campaign, **fonts); !sound) return fail(sound.error());
  const Wording words(in.templates, language, {"results", "report"}),
      pictures(in.templates, language, {"pictures"});
  const reports::Document document = compose({{in, *look, words, **fonts}, pictures});
  for (const Wording* asked : {&words, &pictures})
    if (const auto complete = asked->complete(); !complete) return fail(complete.error());
  auto bytes = reports::pdf(document, **fonts);
  if (!bytes) return fail(bytes.error());
  OutputResult result;
  result.artifacts.push_back({language == "en" ? "report.pdf" : "report-" + language + ".pdf",
                              std::move(*bytes), in.options.flag("sign")});
  return result;
}

}  // namespace
}  // namespace nonio::pdf_report

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {
      "pdf-report",
      "1.0.0",
      "The campaign's report as a PDF with plots, in English or Italian.",
      {{"language", std::string("en"), "", "Language of the report.", {"en", "it"}},
       {"template", std::string("report"), "", "Name of the template: templates/<name>.toml."},
       {"sign", false, "", "Have it signed with the key of [signing] in site.toml."}}};
  output.stage = nonio::Output::Stage::document;
  output.applies = nonio::pdf_report::applies;
  output.write = nonio::pdf_report::write;
  output.prepare = nonio::pdf_report::prepare;
  registry.add(std::move(output));
}
