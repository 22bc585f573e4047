// SPDX-License-Identifier: Apache-2.0
// The report of a campaign as a PDF. Its texts and layout are in templates/.
#include "nonio/sdk/plugin.h"

#include <algorithm>

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

}  // namespace nonio::pdf_report
