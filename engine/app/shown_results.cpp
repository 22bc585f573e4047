// SPDX-License-Identifier: Apache-2.0
#include "shown_results.h"

#include "batch/state/run_state.h"
#include "campaign/config/template_files.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "certificates/certificate_list.h"
#include "platform/storage/files.h"
#include "platform/storage/json_numbers.h"
#include "results_folder.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

Expected<Shown> evaluated_now(const fs::path& folder, const Common& common, Documents documents) {
  auto place = reading::open_workplace(folder, common.plugin_folders(), common.template_folders(),
                                       NONIO_VERSION);
  if (!place) return fail(place.error());
  if (!common.quiet)
    for (const std::string& note : (*place)->notes) complain(note);
  const reading::Context& context = (*place)->context;
  const reading::Stage stage = [](const std::string&) {};
  evaluation::AnalysedCampaign analysed = evaluation::analyse(
      reading::read_campaign(folder, context, stage), id_of_campaign(folder), context, stage, {});
  std::vector<Observations> observations = analysed.read.observations;
  if (documents == Documents::left_out) analysed.documents.clear();
  const evaluation::Evaluated evaluated =
      evaluation::write_documents(std::move(analysed), nullptr, context, stage);
  std::string text = evaluation::results_json(evaluated, context);
  std::vector<std::string> notes;
  if (const std::string& language = context.site.language; language != "en")
    notes = evaluation::notes_in(language, evaluated.results, context.templates);
  return Shown{std::move(text), std::move((*place)->context.templates), context.site.language,
               std::move(observations), std::move(notes)};
}

Expected<Shown> of_run(const fs::path& folder, const Common& common) {
  auto text = storage::read_file(folder / evaluation::results_name);
  if (!text) return fail(text.error());
  std::string language = "en", digest;
  std::vector<std::string> notes;
  if (auto record = evaluation::read_record(folder); record && !record->language.empty()) {
    language = record->language;
    notes = std::move(record->notes);
  }
  auto templates = config::read_templates(common.template_folders(), digest, nullptr, {},
                                          config::words_in(language));
  if (!templates) return fail(templates.error());
  return Shown{std::move(*text), std::move(*templates), language, {}, std::move(notes)};
}

Json results_of(const Shown& shown) {
  Json results = storage::parse(shown.text);
  std::vector<Json*> notes;
  const auto collect = [&](Json& of) {
    if (of.contains("notes"))
      for (Json& note : of.at("notes")) notes.push_back(&note);
  };
  for (const char* list : {"analyses", "tables"})
    if (results.contains(list))
      for (Json& one : results.at(list)) collect(one);
  collect(results);
  if (notes.size() == shown.notes.size())  // not so for records of earlier versions
    for (std::size_t i = 0; i < notes.size(); ++i) *notes[i] = shown.notes[i];
  return results;
}

bool is_out_of_force(const fs::path& results, const std::string& number) {
  const fs::path above = fs::absolute(results).lexically_normal().parent_path();
  for (const fs::path& out : {above, above.parent_path()}) {  // OUT/<id> or OUT/ab/<id>
    const std::string site = batch::site_of(out);
    if (site.empty()) continue;
    const auto numbers = certificates::out_of_force(site);
    return numbers && numbers->contains(number);
  }
  return false;
}

Finding finding_of(const Json& json) {
  Finding f{.id = json.at("id"), .attention = json.at("severity") == "attention"};
  for (const auto& [key, value] : json.at("evidence").items())
    if (value.is_string())
      f.texts.emplace_back(key, value.get<std::string>());
    else
      f.evidence.push_back(storage::number_of(key, value));
  f.advice = json.value("advice", "");
  f.measurement = json.value("measurement", "");
  return f;
}

}  // namespace nonio::app
